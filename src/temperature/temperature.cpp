#include <pcor/temperature/temperature.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/format_estimate.hpp>
#include <pcor/effects/humidity_error.hpp>
#include <pcor/effects/psfd_bias.hpp>
#include <pcor/effects/static_alpha.hpp>
#include <pcor/effects/static_attack.hpp>
#include <pcor/effects/static_qp.hpp>
#include <pcor/effects/temp_calibration.hpp>
#include "model_io/calibration.hpp"
#include "numerics/median.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/flight_partition.hpp"
#include "temperature/degrees.hpp"
#include "temperature/height_least_squares.hpp"
#include "temperature/height_likelihood.hpp"
#include "temperature/isobar_slope.hpp"
#include "temperature/parts.hpp"
#include "temperature/read_heights.hpp"
#include "temperature/temperature_notes.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr double law_default = 0.3;  // hPa, the rms of the memo's eq. 18
constexpr double significant = 2.6;  // standard errors, which chance makes once in 100 times

class TemperatureCalibration {
 public:
  TemperatureCalibration(const FlightSet& flights, const ModelDefinition& model,
                         const TemperatureOptions& options)
      : flights_(flights), model_(model), options_(options), workers_(flights.comm(), options.threads) {
    prior_.slope = options.slope == IsobarSlope::none ? 0.0 : options.slope_size;
  }

  TemperatureResult run() {
    read();
    find_prior();
    terms_ = static_cast<std::size_t>(options_.degree.value_or(2)) + 1;
    most_likely_.noise = start();
    maximise();
    std::vector<HeightEquations> equations;
    for (const HeightRecord& record : records_)
      equations.push_back(height_equations(record, most_likely_.noise, prior_));
    const DegreeSelection degrees = select_degree(equations, terms_);
    result_.degrees = degrees.choices;
    if (!options_.degree) terms_ = degrees.terms;
    fit();
    describe_flights();
    result_.model = with_calibration(model_, result_.likelihood.coefficients,
                                     result_.likelihood.standard_errors, result_.covariance);
    write_notes();
    write_provenance();
    return std::move(result_);
  }

 private:
  void read() {
    flights_.require_each_once();
    flights_.require_one_aircraft();
    std::size_t done = 0;
    auto parts = flights_.partition().all_gather_flights<FlightHeightRecord>([&](std::size_t number) {
      FlightHeightRecord part = read_heights(flights_, number, model_, options_);
      if (options_.progress) options_.progress(++done, flights_.partition().local_count());
      return part;
    });
    for (std::size_t number = 0; number < flights_.size(); ++number) {
      FlightHeightRecord& part = parts[number];
      FlightHeights& heights = result_.flights.emplace_back();
      heights.flight = flights_.name(number);
      heights.excluded = part.excluded;
      if (!part.record) continue;
      if (dry_air_objection_.empty()) dry_air_objection_ = part.dry;
      levelled_.push_back(*part.record);
      // Least squares and figures do not fit a slope.
      const bool fitted = options_.slope == IsobarSlope::fitted;
      subtract_isobar_slope(levelled_.back(), fitted ? IsobarSlope::whole_flight : options_.slope);
      subtract_isobar_slope(*part.record, options_.slope);
      records_.push_back(std::move(*part.record));
    }
    if (!records_.empty()) return;
    if (flights_.size() == 1) throw Error(parts.front().code, parts.front().excluded);
    throw Error(Error::Code::samples, fmt::format("no usable flight among {} flights; the first: {}",
                                                  flights_.size(), parts.front().excluded));
  }

  /// Priors of the other errors: of the humidity its typical error. The error of each term of the model is
  /// that stated, or the typical one of models; a term missing from a model without stated errors has the
  /// typical size of its effect.
  void find_prior() {
    double variances = 0.0;
    HeightUnknowns squares = HeightUnknowns::Zero();
    bool is_stated = true;
    for (const HeightRecord& record : records_) {
      is_stated = is_stated && record.law_variance;
      variances += record.law_variance.value_or(0.0);
      squares += record.rms_of_unit.cwiseAbs2();
    }
    const auto count = static_cast<double>(records_.size());
    const double rms = is_stated ? std::sqrt(variances / count) : model_.law.rms_hpa.value_or(law_default);
    law_error_ = std::hypot(rms, usual_zero);
    const auto size = [&](HeightError error, const EffectInfo& effect) {
      const double typical = effect.parameters[0].typical;
      const bool is_in_law = has_effect(model_, effect.id);
      if (!(squares[error] > 0.0) || !(is_stated || model_.law.rms_hpa || is_in_law)) return typical;
      return std::min(typical, law_error_ / std::sqrt(squares[error] / count));
    };
    prior_.sizes[with_dynamic] = size(with_dynamic, effects::StaticQp::info());
    prior_.sizes[with_attack] = size(with_attack, attack_effect());
    prior_.sizes[with_vapor] = effects::HumidityError::info().parameters[0].typical;
  }

  EffectInfo attack_effect() const {
    return model_.variables.count(Quantity::attack_differential_pressure) > 0 ? effects::StaticAlpha::info()
                                                                              : effects::StaticAttack::info();
  }

  /// Initial noise: of modern differential GPS if its heights are that smooth, otherwise of older GPS.
  HeightNoise start() const {
    std::vector<double> changes;
    for (const HeightRecord& record : records_) {
      for (std::size_t i = 1; i < record.blocks.size(); ++i) {
        if (!record.blocks[i].starts_segment)
          changes.push_back(std::abs(record.blocks[i].excess - record.blocks[i - 1].excess));
      }
    }
    HeightNoise noise;
    if (changes.empty()) return noise;
    noise.white = noise.wander = std::max(0.02, median(std::move(changes)));
    noise.walk = 0.05 * noise.white;
    return noise;
  }

  void maximise() {
    most_likely_ = maximise_likelihood(records_, as_index(terms_), prior_, most_likely_.noise, workers_);
  }

  /// Implausible coefficients of the most likely correction: "a1 = -0.0785, outside [-0.05, 0.05]". Empty if
  /// it is possible.
  std::string impossible() const {
    const Eigen::VectorXd best = most_likely_.equations.best(as_index(terms_));
    for (std::size_t k = 0; k < terms_; ++k) {
      const ParameterInfo info = effects::TempCalibration::info().parameters[k];
      const double value = best[as_index(k)];
      if (value < info.lower || value > info.upper) {
        return fmt::format("{} = {:.3g} {}, outside [{:g}, {:g}]", info.name, value, info.unit, info.lower,
                           info.upper);
      }
    }
    return "";
  }

  void fit() {
    maximise();
    while (!options_.degree && terms_ > 1 && !impossible().empty()) {
      result_.notes_on_degree.push_back(
          fmt::format("a correction of degree {} is rejected as physically implausible ({}); it needs more "
                      "climbs and descents through other temperatures",
                      terms_ - 1, impossible()));
      --terms_;
      maximise();
    }
    if (const std::string problem = impossible(); !problem.empty()) {
      throw Error(
          Error::Code::fit,
          fmt::format("the correction of the temperature is physically implausible: {}; {}", problem,
                      terms_ > 1
                          ? "these flights do not determine this number of coefficients: reduce --degree"
                          : "check recovery_temperature and the altitude in the model"));
    }
    const Eigen::Index n = as_index(terms_);
    const HeightEquations& equations = most_likely_.equations;
    unknowns_ = equations.best_unknowns(n);
    Eigen::MatrixXd covariance = covariance_over_noise(records_, n, prior_, most_likely_, workers_);
    const HeightEquations::Matrix of_unknowns = equations.covariance_of_unknowns(n);
    const Eigen::MatrixXd moved_by =
        of_unknowns * equations.information.rightCols<height_unknowns - lasting>();
    const Eigen::VectorXd per_hpa = moved_by.col(0).head(n);
    const Eigen::VectorXd per_part = moved_by.col(with_static - lasting).head(n);
    find_parts();
    find_law_error(effects::StaticQp::info(), with_dynamic, of_unknowns);
    find_law_error(attack_effect(), with_attack, of_unknowns);
    result_.humidity_change = unknowns_[with_vapor];
    result_.humidity_error = std::sqrt(of_unknowns(with_vapor, with_vapor));
    find_unseen_errors();
    const Eigen::MatrixXd unseen = covariance_of_unseen(per_hpa, per_part / mean_pressure());
    const HeightNoise& noise = most_likely_.noise;
    result_.likelihood.sigma = std::hypot(noise.white, noise.wander);
    for (Eigen::Index k = 0; k < n; ++k) {
      result_.likelihood.coefficients.push_back(unknowns_[k]);
      result_.likelihood.standard_errors.push_back(std::sqrt(covariance(k, k) + unseen(k, k)));
      result_.per_hpa.push_back(per_hpa[k]);
      std::vector<double>& row = result_.covariance.emplace_back();
      for (Eigen::Index j = 0; j < n; ++j) row.push_back(covariance(k, j) + unseen(k, j));
    }
    result_.gps_noise = noise.white;
    result_.gps_wander = noise.wander;
    result_.gps_wander_time = noise.wander_time;
    result_.drift = noise.walk * std::sqrt(60.0);
    result_.least_squares = fit_height_by_least_squares(levelled_, terms_);
    compare_with_least_squares();
    find_corrections();
  }

  double mean_pressure() const {
    double sum = 0.0;
    double count = 0.0;
    for (const HeightRecord& record : records_) {
      for (const HeightBlock& block : record.blocks) sum += block.pressure;
      count += static_cast<double>(record.blocks.size());
    }
    return sum / count;
  }

  /// Errors of the pressure that heights cannot separate from a thermometer error: the zero of the
  /// transducer, as stated in the model for psfd-bias, and an error of the model proportional to the
  /// pressure. If heights show that the model errs by more than stated, the latter may be larger, too.
  void find_unseen_errors() {
    result_.pressure_error = options_.pressure_error.value_or(stated_zero().value_or(usual_zero));
    result_.law_error = options_.pressure_error.value_or(law_error_);
    if (options_.pressure_error) return;
    for (const LawError& error : result_.law_errors) {
      if (is_beyond_prior(error)) result_.law_error = std::hypot(result_.law_error, error.range);
    }
  }

  std::optional<double> stated_zero() const {
    for (std::size_t e = 0; e < model_.model.effects.size(); ++e) {
      if (model_.model.effects[e].id == effects::PsfdBias::info().id) return model_.fit(e, 0).standard_error;
    }
    return std::nullopt;
  }

  /// Covariance of errors that the likelihood cannot detect. Constant errors of the pressure: in hPa,
  /// detectable from the shape of the heights only if that of the thermometer's error were known, or relative
  /// to the pressure, which affects the temperature only. And the spread between flights, between climbs and
  /// descents, and between halves, which limits the accuracy of a common correction.
  Eigen::MatrixXd covariance_of_unseen(const Eigen::VectorXd& per_hpa,
                                       const Eigen::VectorXd& per_hpa_in_proportion) const {
    const Eigen::VectorXd by_zero = result_.pressure_error * per_hpa;
    const Eigen::VectorXd by_law = result_.law_error * per_hpa_in_proportion;
    Eigen::MatrixXd covariance = by_zero * by_zero.transpose() + by_law * by_law.transpose();
    // Between one climb and one descent, both of the latter are the same.
    const double within_flights = std::max(result_.spread_of_climbs, result_.spread_of_halves);
    covariance(0, 0) +=
        result_.spread_of_flights * result_.spread_of_flights + within_flights * within_flights;
    return covariance;
  }

  void find_parts() {
    result_.parts_by_flight = corrections_of_flights(records_, most_likely_.noise, prior_, unknowns_);
    result_.parts_by_climb =
        corrections_of_climbs_and_descents(records_, most_likely_.noise, prior_, unknowns_, workers_);
    result_.parts_by_half = corrections_of_halves(records_, most_likely_.noise, prior_, unknowns_, workers_);
    result_.spread_of_flights = disagreement_of(result_.parts_by_flight).spread;
    result_.spread_of_climbs = disagreement_of(result_.parts_by_climb).spread;
    result_.spread_of_halves = disagreement_of(result_.parts_by_half).spread;
  }

  /// Range of the static pressure over the segments due to an error of one unit, hPa.
  double range_of(HeightError error) const {
    double range = 0.0;
    double minimum = 0.0;
    double maximum = 0.0;
    for (const HeightRecord& record : records_) {
      for (const HeightBlock& block : record.blocks) {
        const double pressure = block.columns[error] / block.metres_per_hpa;
        if (block.starts_segment) minimum = maximum = pressure;
        minimum = std::min(minimum, pressure);
        maximum = std::max(maximum, pressure);
        range = std::max(range, maximum - minimum);
      }
    }
    return range;
  }

  void find_law_error(const EffectInfo& effect, HeightError error,
                      const HeightEquations::Matrix& covariance) {
    if (!(most_likely_.equations.information(error, error) > 0.0)) return;
    LawError& found = result_.law_errors.emplace_back();
    found.effect = effect.id;
    found.parameter = effect.parameters[0].name;
    // A pressure that is too high needs a correction that is lower.
    found.change = -unknowns_[error];
    found.standard_error = std::sqrt(covariance(error, error));
    found.size = prior_.sizes[error];
    found.range = std::abs(found.change) * range_of(error);
  }

  /// Constant that least squares adds to the correction, after removal of the other errors, with the slopes
  /// of isobars of each flight as unknowns: slopes estimated beforehand would include errors of the model
  /// that differ between climbs and descents. Weighted mean over the flights.
  void compare_with_least_squares() {
    double weights = 0.0;
    double sum = 0.0;
    for (const HeightRecord& record : records_) {
      HeightRecord without_errors = without_unknowns(record, unknowns_);
      const bool one_direction = record.way == WayKnown::length;
      for (HeightBlock& block : without_errors.blocks) {
        block.columns[1] = one_direction ? block.north : block.east;
        block.columns[2] = block.north;
      }
      const std::size_t terms = prior_.slope == 0.0 ? 1 : one_direction ? 2 : 3;
      const TemperatureFit fit = fit_height_by_least_squares({without_errors}, terms);
      const double error =
          fit.standard_errors[0] * std::sqrt(samples_as_one(without_errors, fit.coefficients));
      if (!std::isfinite(error) || !(error > 0.0) || !std::isfinite(fit.coefficients[0])) continue;
      weights += 1.0 / (error * error);
      sum += fit.coefficients[0] / (error * error);
    }
    result_.least_squares_add = sum / weights;
    result_.least_squares_add_error = std::sqrt(1.0 / weights);
  }

  void find_corrections() {
    double coldest = std::numeric_limits<double>::infinity();
    double warmest = -coldest;
    for (const HeightRecord& record : records_) {
      coldest = std::min(coldest, record.min_temperature);
      warmest = std::max(warmest, record.max_temperature);
    }
    constexpr int steps = 4;
    for (int i = 0; i <= steps; ++i) {
      TemperatureCorrection at;
      at.temperature = coldest + (warmest - coldest) * i / steps;
      at.correction = correction_at(at.temperature, result_.likelihood.coefficients);
      double variance = 0.0;
      for (std::size_t k = 0; k < terms_; ++k) {
        for (std::size_t j = 0; j < terms_; ++j)
          variance += result_.covariance[k][j] * std::pow(at.temperature, static_cast<double>(k + j));
      }
      at.standard_error = std::sqrt(variance);
      result_.corrections.push_back(at);
    }
  }

  void describe_flights() {
    double squares = 0.0;
    double products = 0.0;
    double count = 0.0;
    auto record = records_.begin();
    auto levelled = levelled_.begin();
    for (FlightHeights& flight : result_.flights) {
      if (!flight.excluded.empty()) continue;
      flight.samples = record->samples;
      flight.segments = record->segments;
      flight.min_temperature = record->min_temperature;
      flight.max_temperature = record->max_temperature;
      for (const HeightBlock& block : record->blocks) {
        flight.time.push_back(block.time);
        flight.height.push_back(block.height);
        flight.temperature.push_back(block.temperature);
      }
      flight.before = height_differences(*levelled, {});
      flight.after = height_differences(*levelled, result_.likelihood.coefficients);
      flight.rms_before = rms(flight.before);
      flight.rms_after = rms(flight.after);
      flight.innovation = height_innovations(*record, most_likely_.noise, prior_, unknowns_);
      for (std::size_t i = 1; i < flight.innovation.size(); ++i) {
        const double product = flight.innovation[i] * flight.innovation[i - 1];
        if (std::isnan(product)) continue;
        products += product;
        squares += flight.innovation[i] * flight.innovation[i];
        count += 1.0;
      }
      result_.samples += record->samples;
      ++record;
      ++levelled;
    }
    result_.innovation_variance = squares / count;
    result_.innovation_correlation = products / squares;
  }

  static double rms(const std::vector<double>& values) {
    const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
    return std::sqrt(squares / static_cast<double>(values.size()));
  }

  /// Rms of heights about their mean in each segment, with a correction and without the other errors, m.
  double rms_without_other_errors(const std::vector<double>& coefficients) const {
    HeightUnknowns others = unknowns_;
    others.head<lasting>().setZero();
    std::vector<double> heights;
    for (const HeightRecord& record : levelled_) {
      const std::vector<double> differences =
          height_differences(without_unknowns(record, others), coefficients);
      heights.insert(heights.end(), differences.begin(), differences.end());
    }
    return rms(heights);
  }

  /// Reason why the correction does not improve the heights; empty if it improves them.
  std::string reason_against() const {
    if (!dry_air_objection_.empty()) return dry_air_objection_;
    const double gain = result_.degrees.front().deviance - result_.degrees[terms_].deviance;
    if (gain < worthwhile_gain) {
      return fmt::format("the correction is not significant: -2 ln L decreases by {:.1f} (threshold {:g})",
                         gain, worthwhile_gain);
    }
    // The correction with the largest ratio to its standard error.
    const TemperatureCorrection& at = *std::max_element(
        result_.corrections.begin(), result_.corrections.end(), [](const auto& one, const auto& other) {
          return std::abs(one.correction) * other.standard_error <
                 std::abs(other.correction) * one.standard_error;
        });
    if (std::abs(at.correction) < significant * at.standard_error) {
      return fmt::format(
          "the correction is not significant: {} K at {:.0f} C, the best determined temperature; threshold "
          "{:g} standard errors (p = 0.01)",
          format_estimate(at.correction, at.standard_error), at.temperature, significant);
    }
    const double before = rms_without_other_errors({});
    const double after = rms_without_other_errors(result_.likelihood.coefficients);
    if (after > before) {
      return fmt::format(
          "height rms without the other fitted errors is {:.2f} m with the correction and {:.2f} m without "
          "it, "
          "although the likelihood improves",
          after, before);
    }
    if (std::abs(result_.least_squares_add) > significant_ratio * result_.least_squares_add_error) {
      return fmt::format(
          "least squares on height contradicts the likelihood: it would add {} K to the correction, more "
          "than {:g} standard errors",
          format_estimate(result_.least_squares_add, result_.least_squares_add_error), significant_ratio);
    }
    for (const std::vector<PartCorrection>* parts : result_.parts()) {
      for (const PartCorrection& part : *parts) {
        if (!is_made_worse(part)) continue;
        return fmt::format(
            "the correction degrades {} by more than three standard errors; separate fit {} K, common "
            "correction {:+.2f} K",
            part.part, format_estimate(part.correction, part.standard_error), part.common);
      }
    }
    return "";
  }

  void write_notes() {
    result_.rejection_reason = reason_against();
    result_.warnings = temperature_warnings(result_);
    if (!result_.rejection_reason.empty()) result_.notes.push_back(result_.rejection_reason);
    if (!options_.degree && records_.size() < min_for_choice) {
      result_.notes_on_degree.push_back(fmt::format(
          "set the degree with --degree if you know it: {} flight{} cannot be cross-validated; the degree "
          "was chosen by the likelihood (decrease of -2 ln L above {:.0f} per coefficient)",
          records_.size(), records_.size() == 1 ? "" : "s", worthwhile_gain));
    }
    const bool attack_is_unknown = prior_.sizes[with_attack] > 0.0 &&
                                   !(most_likely_.equations.information(with_attack, with_attack) > 0.0);
    for (const Notes& more :
         {result_.notes_on_degree, noise_notes(result_), method_notes(options_, attack_is_unknown),
          record_notes(records_, options_.slope)})
      result_.notes.insert(result_.notes.end(), more.begin(), more.end());
  }

  void write_provenance() {
    ProvenanceList flights;
    for (const FlightHeights& flight : result_.flights) {
      if (flight.excluded.empty()) flights.emplace_back(ProvenanceValue{flight.flight});
    }
    Provenance temperature{{"program", std::string("pcor " PCOR_VERSION)},
                           {"method", std::string("likelihood of heights by GPS")},
                           {"slope_of_isobars", std::string(to_string(options_.slope))},
                           {"flights", std::move(flights)},
                           {"samples", static_cast<std::int64_t>(result_.samples)},
                           {"sigma_m", result_.likelihood.sigma},
                           {"pressure_error_hpa", result_.pressure_error},
                           {"law_error_hpa", result_.law_error}};
    set_entry(result_.model.provenance, "temperature", std::move(temperature));
  }

  const FlightSet& flights_;
  const ModelDefinition& model_;
  const TemperatureOptions& options_;
  Workers workers_;
  std::string dry_air_objection_;  // objection to dry air for a flight in use
  double law_error_ = 0.0;         // standard deviation of delta-p, hPa, before the heights are seen
  HeightPrior prior_;
  std::vector<HeightRecord> records_;
  std::vector<HeightRecord> levelled_;  // heights after subtraction of an estimated isobar slope
  MostLikely most_likely_;
  HeightUnknowns unknowns_ = HeightUnknowns::Zero();  // the most likely ones
  std::size_t terms_ = 1;
  TemperatureResult result_;
};

}  // namespace

TemperatureCorrection TemperatureResult::largest_correction() const {
  TemperatureCorrection largest;
  for (const TemperatureCorrection& at : corrections) {
    if (at.min_size() > largest.min_size()) largest = at;
  }
  return largest;
}

bool TemperatureResult::is_implausible() const {
  return largest_correction().min_size() > 5.0 * usual_thermometer_error;
}

TemperatureResult fit_temperature(const FlightSet& flights, const ModelDefinition& model,
                                  const TemperatureOptions& options) {
  if (flights.empty())
    throw Error(Error::Code::usage, "no flights for the temperature fit; give at least one flight");
  constexpr int max_degree = static_cast<int>(calibration_terms) - 1;
  if (options.degree && (*options.degree < 0 || *options.degree > max_degree))
    throw Error(Error::Code::usage,
                fmt::format("the degree {} of the correction is not supported; give a degree from "
                            "0 to {}",
                            *options.degree, max_degree));
  TemperatureResult result = TemperatureCalibration(flights, model, options).run();
  flights.require_unchanged();
  return result;
}

}  // namespace pcor
