#include "campaign/gps_system.hpp"

#include <gmock/gmock.h>
#include <pcor/effects/catalogue.hpp>
#include <pcor/roles/add_effects.hpp>
#include <pcor/simulate/simulate.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "support/temporary_directory.hpp"

using pcor::ModelDefinition;
using pcor::References;
using namespace pcor::internal;

namespace {

const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

/// A simulated flight of two hours. @param effect of the scenario, hidden
std::filesystem::path flight(int seed, const std::string& effect = "") {
  static const pcor::test::TemporaryDirectory directory;
  std::ifstream file(scenarios / "c130-eq18.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t place = text.find("\nseed = ");
  text.replace(place, text.find('\n', place + 1) - place, "\nseed = " + std::to_string(seed));
  const std::filesystem::path path =
      directory / (std::to_string(seed) + (effect.empty() ? "" : "-hidden") + ".nc");
  if (!std::filesystem::exists(path))
    pcor::simulate_flight(pcor::parse_scenario(text + effect, "test"), path);
  return path;
}

const std::vector<std::string> tested{"static-mach3", "static-beta-odd", "static-alpha-quad", "static-lag",
                                      "roll-static",  "load-factor",     "pitot-angle",       "qcf-zero"};

/// Decrease of chi2 by each tested effect, with law and nuisances fitted.
std::map<std::string, double> gains(const std::filesystem::path& path, bool with_height) {
  const ModelDefinition law = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  std::vector<pcor::ModelEffect> effects;
  for (const std::string& id : tested) effects.push_back(pcor::neutral_effect(id));
  const ModelDefinition model = pcor::add_effects(law, effects, pcor::FlightSet({path}).variables().front());
  GpsColumns columns;
  std::vector<std::string> names;
  std::size_t place = 0;
  for (const pcor::ModelEffect& effect : model.model.effects) {
    const auto& info = pcor::effect_info[pcor::effect_named(effect.id)];
    for (std::size_t p = 0; p < effect.parameters.size(); ++p, ++place) {
      const bool is_shape = names.size() > law.model.effects.size() && p > 0;
      if (is_shape) continue;
      columns.places.push_back(place);
      columns.usual.push_back(std::abs(info.parameters[p].typical));
      names.push_back(effect.id);
    }
  }
  columns.own = law.model.effects.size();
  References references{pcor::wind_reference(model)};
  if (with_height) references.push_back(pcor::height_reference(model));
  const GpsSystem system = gps_system({path}, model, references, {}, columns);
  Eigen::MatrixXd sums = system.prior.transpose() * system.prior;
  for (const GpsFlightSystem& each : system.flights) sums += each.rows.transpose() * each.rows;
  const auto own = static_cast<Eigen::Index>(columns.own);
  const auto count = static_cast<Eigen::Index>(columns.places.size());
  std::vector<Eigen::Index> base;
  for (Eigen::Index k = 0; k < sums.rows() - 1; ++k) {
    if (k < own || k >= count) base.push_back(k);
  }
  const Eigen::MatrixXd inner = sums(base, base);
  const Eigen::LDLT<Eigen::MatrixXd> solver(inner);
  std::map<std::string, double> result;
  for (Eigen::Index k = own; k < count; ++k) {
    const Eigen::VectorXd cross = sums(base, k);
    const Eigen::VectorXd weights = solver.solve(cross);
    const Eigen::VectorXd right = sums(base, sums.rows() - 1);
    const double information = sums(k, k) - cross.dot(weights);
    const double score = sums(k, sums.rows() - 1) - weights.dot(right);
    result[names[static_cast<std::size_t>(k)]] = score * score / information;
  }
  return result;
}

}  // namespace

TEST(GpsSystem, GainsWithoutEffectAreThoseOfChance) {
  for (const bool with_height : {false, true}) {
    double sum = 0.0;
    double count = 0.0;
    for (const int seed : {1, 2, 3, 4}) {
      for (const auto& [name, gain] : gains(flight(seed), with_height)) {
        sum += gain;
        count += 1.0;
        // One of 32 numbers of chi2 with one degree is above 13 in 1 % of the cases.
        EXPECT_LT(gain, 13.0) << name << ", seed " << seed << (with_height ? ", with height" : "");
      }
    }
    // The mean of 32 is 1 +- 0.25; the columns of a flight are not independent, which doubles it.
    EXPECT_NEAR(sum / count, 1.0, 1.0) << (with_height ? "with height" : "wind alone");
  }
}

TEST(GpsSystem, HiddenEffectGainsMoreThanOthers) {
  struct Case {
    std::string id, parameter;
    bool with_height;
  };
  for (const Case& hidden :
       {Case{"static-beta-odd", "b1 = 0.01", false}, Case{"roll-static", "defect = 0.5", true}}) {
    const std::string effect = "\n[[effect]]\nid = \"" + hidden.id + "\"\n" + hidden.parameter + "\n";
    const int seed = hidden.with_height ? 21 : 26;
    for (const auto& [name, gain] : gains(flight(seed, effect), hidden.with_height)) {
      if (name == hidden.id)
        EXPECT_GT(gain, 200.0);
      else
        EXPECT_LT(gain, 13.0) << name << " beside " << hidden.id;
    }
  }
}
