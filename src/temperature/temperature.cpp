#include <pcor/temperature/temperature.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <thread>
#include <utility>

#include <pcor/effects/temp_calibration.hpp>
#include <pcor/flight/same_aircraft.hpp>
#include <pcor/words/error.hpp>
#include "laws/archived_model.hpp"
#include "laws/calibration.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "residuals/flight_air.hpp"
#include "roles/recorded_model.hpp"
#include "temperature/archived_steps.hpp"
#include "temperature/degrees.hpp"
#include "temperature/height_least_squares.hpp"
#include "temperature/height_likelihood.hpp"
#include "temperature/isobar_slope.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr double much_noise = 3.0;  // m, of the GPS height
constexpr double much_drift = 1.0;  // m in a minute; a usual slope of isobars, 10 m in 100 km, makes 0.7

constexpr std::array<std::pair<IsobarSlope, std::string_view>, 6> slope_names{{
    {IsobarSlope::fitted, "fitted"},
    {IsobarSlope::none, "none"},
    {IsobarSlope::level_legs, "level-legs"},
    {IsobarSlope::climb_descent, "climb-descent"},
    {IsobarSlope::whole_flight, "whole-flight"},
    {IsobarSlope::geostrophic, "geostrophic"},
}};

class TemperatureCalibration {
 public:
  TemperatureCalibration(const ModelFile& model, const TemperatureOptions& options)
      : model_(model), bare_(without_calibration(model)), options_(options) {
    threads_ =
        options.threads > 0 ? options.threads : std::max<std::size_t>(1, std::thread::hardware_concurrency());
    prior_.slope = options.slope == IsobarSlope::none ? 0.0 : options.slope_size;
    prior_.pressure = options.pressure_error;
  }

  TemperatureResult run(const std::vector<std::filesystem::path>& paths) {
    read(paths);
    const std::size_t most = static_cast<std::size_t>(options_.degree.value_or(2)) + 1;
    likeliest_ = maximise_likelihood(records_, static_cast<Eigen::Index>(most), prior_, start(), threads_);
    std::vector<HeightEquations> equations;
    for (const HeightRecord& record : records_)
      equations.push_back(height_equations(record, likeliest_.noise, prior_));
    const Degrees degrees(equations, most);
    result_.degrees = degrees.choices();
    terms_ = options_.degree ? most : degrees.worthwhile_terms();
    fit();
    describe_flights();
    write_notes();
    result_.model = with_calibration(model_, result_.likelihood.coefficients,
                                     result_.likelihood.standard_errors, result_.covariance);
    write_provenance();
    return std::move(result_);
  }

 private:
  void read(const std::vector<std::filesystem::path>& paths) {
    require_each_once(paths);
    std::string first_trouble;
    std::vector<std::pair<std::string, std::string>> aircraft;
    for (const std::filesystem::path& path : paths) {
      const Flight flight(path, options_.time_stamp);
      aircraft.emplace_back(path.string(), flight.aircraft());
      FlightHeights heights;
      heights.flight = path.filename().string();
      try {
        HeightRecord record = read_record(flight);
        if (options_.skip_returning && record.returns) {
          heights.left_out = "it ends where it began (--skip-returning)";
        } else {
          levelled_.push_back(record);
          // Least squares and pictures know no slope of their own.
          const bool fitted = options_.slope == IsobarSlope::fitted;
          take_off_isobar_slope(levelled_.back(), fitted ? IsobarSlope::whole_flight : options_.slope);
          take_off_isobar_slope(record, options_.slope);
          records_.push_back(std::move(record));
        }
      } catch (const Error& error) {
        heights.left_out = error.what();
      }
      if (first_trouble.empty()) first_trouble = heights.left_out;
      result_.flights.push_back(std::move(heights));
      if (options_.progress) options_.progress(result_.flights.size(), paths.size());
    }
    require_one_aircraft(aircraft);
    if (!records_.empty()) return;
    if (paths.size() == 1) throw Error(first_trouble);
    throw Error(
        fmt::format("none of the {} flights can be used; the first: {}", paths.size(), first_trouble));
  }

  HeightRecord read_record(const Flight& flight) const {
    HeightRecordOptions record_options;
    record_options.least_climb_rate = options_.least_climb_rate;
    FlightAir air;
    std::vector<double> steps;
    if (options_.archived) {
      std::optional<ModelFile> recorded = recorded_model(flight);
      if (!recorded || recorded->variables.count(Quantity::ambient_temperature) == 0) {
        throw Error(
            fmt::format("{}: --archived needs PSXC, QCXC and ATX as pcor process writes them; leave it out "
                        "for raw flights",
                        flight.path().string()));
      }
      for (const Quantity role : flown_quantities) {
        if (model_.variables.count(role) > 0) recorded->variables[role] = model_.variables.at(role);
        if (model_.units.count(role) > 0) recorded->units[role] = model_.units.at(role);
      }
      air = read_flight_air(flight, *recorded, options_.mask);
      steps = archived_steps(flight, model_, air);
    } else {
      air = read_flight_air(flight, bare_, options_.mask);
    }
    return height_record(air, steps, record_options);
  }

  /// Noise to start from: of modern differential GPS where heights change that little, else of older.
  HeightNoise start() const {
    std::vector<double> changes;
    for (const HeightRecord& record : records_) {
      for (std::size_t i = 1; i < record.blocks.size(); ++i) {
        if (!record.blocks[i].starts_stretch)
          changes.push_back(std::abs(record.blocks[i].excess - record.blocks[i - 1].excess));
      }
    }
    HeightNoise noise;
    if (changes.empty()) return noise;
    const double size = std::max(0.02, median(std::move(changes)));
    noise.white = size;
    noise.wander = size;
    noise.walk = 0.05 * size;
    return noise;
  }

  void maximise() {
    likeliest_ =
        maximise_likelihood(records_, static_cast<Eigen::Index>(terms_), prior_, likeliest_.noise, threads_);
  }

  /// What the most likely correction has that no thermometer needs: "a1 = -0.0785, outside [-0.05, 0.05]".
  /// Empty where it is possible.
  std::string impossible() const {
    const Eigen::VectorXd best = likeliest_.equations.best(static_cast<Eigen::Index>(terms_));
    for (std::size_t k = 0; k < terms_; ++k) {
      const ParameterFacts facts = effects::TempCalibration::facts().parameters[k];
      const double value = best[static_cast<Eigen::Index>(k)];
      if (value < facts.lower || value > facts.upper) {
        return fmt::format("{} = {:.3g} {}, outside [{:g}, {:g}]", facts.name, value, facts.unit, facts.lower,
                           facts.upper);
      }
    }
    return "";
  }

  void fit() {
    maximise();
    while (!options_.degree && terms_ > 1 && !impossible().empty()) {
      result_.notes_on_degree.push_back(
          fmt::format("a correction of degree {} is given up, as it is physically implausible ({}); "
                      "more climbs and descents through other temperatures would tell it",
                      terms_ - 1, impossible()));
      --terms_;
      maximise();
    }
    if (const std::string trouble = impossible(); !trouble.empty()) {
      throw Error(fmt::format(
          "the correction of the temperature is physically implausible: {}; {}", trouble,
          terms_ > 1 ? "these flights do not tell so many coefficients: lower --degree"
                     : "look whether recovery_temperature and the altitude are what the model says"));
    }
    const auto n = static_cast<Eigen::Index>(terms_);
    const HeightEquations& equations = likeliest_.equations;
    const Eigen::VectorXd best = equations.best(n);
    const Eigen::MatrixXd covariance = covariance_over_noise(records_, n, prior_, likeliest_, threads_);
    const Eigen::VectorXd per_hpa = equations.covariance(n) * equations.pressure_error.head(n);
    const HeightNoise& noise = likeliest_.noise;
    result_.likelihood.sigma = std::hypot(noise.white, noise.wander);
    for (Eigen::Index k = 0; k < n; ++k) {
      result_.likelihood.coefficients.push_back(best[k]);
      result_.likelihood.standard_errors.push_back(std::sqrt(covariance(k, k)));
      result_.per_hpa.push_back(per_hpa[k]);
      std::vector<double>& row = result_.covariance.emplace_back();
      for (Eigen::Index j = 0; j < n; ++j) row.push_back(covariance(k, j));
      result_.profile.push_back(profile_interval(k));
    }
    result_.gps_noise = noise.white;
    result_.gps_wander = noise.wander;
    result_.gps_wander_time = noise.wander_time;
    result_.drift = noise.walk * std::sqrt(60.0);
    result_.pressure_error = prior_.pressure;
    result_.least_squares = fit_height_by_least_squares(levelled_, terms_);
    find_corrections();
  }

  /// Where -2 ln L, with the noise and the other coefficients at their best, is 1 above its least, below and
  /// above.
  std::array<double, 2> profile_interval(Eigen::Index term) const {
    const auto k = static_cast<std::size_t>(term);
    const double best = result_.likelihood.coefficients[k];
    const double error = result_.likelihood.standard_errors[k];
    const auto deviance_at = [&](double value) {
      const HeldCoefficient held{term, value};
      return maximise_likelihood(records_, static_cast<Eigen::Index>(terms_), prior_, likeliest_.noise,
                                 threads_, &held)
          .deviance;
    };
    const double least = deviance_at(best);
    const auto limit = [&](double side) {
      double reach = error;
      for (int step = 0; step < 3; ++step) {
        const double rise = deviance_at(best + side * reach) - least;
        if (!(rise > 0.05) || !std::isfinite(rise)) return nan;
        reach /= std::sqrt(rise);
        if (std::abs(rise - 1.0) < 0.02) break;
      }
      return best + side * reach;
    };
    return {limit(-1.0), limit(1.0)};
  }

  void find_corrections() {
    double coldest = std::numeric_limits<double>::infinity();
    double warmest = -coldest;
    for (const HeightRecord& record : records_) {
      coldest = std::min(coldest, record.least_temperature);
      warmest = std::max(warmest, record.greatest_temperature);
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
    Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < terms_; ++k)
      coefficients[static_cast<Eigen::Index>(k)] = result_.likelihood.coefficients[k];
    double squares = 0.0;
    double products = 0.0;
    double count = 0.0;
    auto record = records_.begin();
    auto levelled = levelled_.begin();
    for (FlightHeights& flight : result_.flights) {
      if (!flight.left_out.empty()) continue;
      flight.samples = record->samples;
      flight.stretches = record->stretches;
      flight.least_temperature = record->least_temperature;
      flight.greatest_temperature = record->greatest_temperature;
      for (const HeightBlock& block : record->blocks) {
        flight.time.push_back(block.time);
        flight.height.push_back(block.height);
        flight.temperature.push_back(block.temperature);
      }
      flight.before = height_differences(*levelled, {});
      flight.after = height_differences(*levelled, result_.likelihood.coefficients);
      flight.rms_before = rms(flight.before);
      flight.rms_after = rms(flight.after);
      flight.innovation = height_innovations(*record, likeliest_.noise, prior_, coefficients);
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
    double squares = 0.0;
    for (const double value : values) squares += value * value;
    return std::sqrt(squares / static_cast<double>(values.size()));
  }

  /// Looks whether the correction explains the heights better than none does.
  void compare_with_none() {
    const double gain = result_.degrees.front().deviance - result_.degrees[terms_].deviance;
    double before = 0.0;
    double after = 0.0;
    for (const FlightHeights& flight : result_.flights) {
      const auto count = static_cast<double>(flight.time.size());
      before += count * flight.rms_before * flight.rms_before;
      after += count * flight.rms_after * flight.rms_after;
    }
    const TemperatureCorrection& middle = result_.corrections[result_.corrections.size() / 2];
    if (gain < worthwhile_gain) {
      result_.no_better =
          fmt::format("these flights do not tell the correction from none: at {:.0f} C it is {} K",
                      middle.temperature, with_error(middle.correction, middle.standard_error));
    } else if (after > before) {
      const auto count = static_cast<double>(std::accumulate(
          result_.flights.begin(), result_.flights.end(), std::size_t{0},
          [](std::size_t sum, const FlightHeights& flight) { return sum + flight.time.size(); }));
      result_.no_better = fmt::format(
          "heights keep less close to the integral with the correction than without (rms {:.2f} m and {:.2f} "
          "m), though it is likelier",
          std::sqrt(after / count), std::sqrt(before / count));
    }
  }

  void write_notes() {
    std::vector<std::string>& notes = result_.notes;
    compare_with_none();
    if (!result_.no_better.empty()) notes.push_back(result_.no_better);
    if (!options_.degree && records_.size() < fewest_for_choice) {
      result_.notes_on_degree.push_back(
          fmt::format("with {} flight{} none can be held out: the degree is chosen by what these flights "
                      "gain (more than {:.0f} in -2 ln L for a coefficient); --degree sets it",
                      records_.size(), records_.size() == 1 ? "" : "s", worthwhile_gain));
    }
    notes.insert(notes.end(), result_.notes_on_degree.begin(), result_.notes_on_degree.end());
    if (std::max(result_.gps_noise, result_.gps_wander) > much_noise || result_.drift > much_drift) {
      notes.push_back(
          fmt::format("the noise that was found is large (GPS height {:.1f} m, drift of the integral {:.1f} "
                      "m in a minute): a lag of the static line or the thermometer, or a law that is wrong "
                      "in climbs, looks like it; the layers of pcor check say whether the pressure lags "
                      "behind the height",
                      std::max(result_.gps_noise, result_.gps_wander), result_.drift));
    }
    if (options_.slope == IsobarSlope::none ||
        (options_.slope == IsobarSlope::fitted && options_.slope_size == 0.0)) {
      notes.emplace_back(
          "isobars are taken for level: 10 m in 100 km along a climb of 5 m/s look like 1 K (--slope "
          "fitted)");
    }
    if (options_.slope == IsobarSlope::geostrophic) {
      notes.emplace_back(
          "the slope of isobars is that of a wind in balance: friction, curved ways of the air and changes "
          "of the wind put it out of balance, and the coefficients are as good as the balance is");
    }
    std::size_t steps = 0;
    std::size_t spikes = 0;
    std::size_t missing = 0;
    std::size_t unknown_ways = 0;
    for (const HeightRecord& record : records_) {
      steps += record.height_steps;
      spikes += record.height_spikes;
      missing += record.missing_heights;
      unknown_ways += record.unknown_ways;
    }
    if (missing > 0) notes.push_back(fmt::format("{} samples have no GPS height", missing));
    if (unknown_ways > 0 && options_.slope != IsobarSlope::none) {
      notes.push_back(fmt::format(
          "{} samples have no velocity over the ground: there the way is that through the air, or goes on as "
          "before",
          unknown_ways));
    }
    if (steps + spikes > 0) {
      notes.push_back(
          fmt::format("the GPS height has {} step(s), at which the integral starts anew, and {} sample(s) in "
                      "spikes, which are left out",
                      steps, spikes));
    }
    if (std::abs(result_.innovation_correlation) > 0.1) {
      notes.push_back(
          fmt::format("the noise is not quite as described: innovations have a correlation of {:+.2f}, so "
                      "errors may be off by some tenths",
                      result_.innovation_correlation));
    }
    std::map<std::string, std::size_t> said;
    for (const HeightRecord& record : records_) {
      for (const std::string& note : record.notes) ++said[note];
    }
    for (const auto& [note, count] : said)
      notes.push_back(count == 1 || records_.size() == 1 ? note
                                                         : fmt::format("{} ({} flights)", note, count));
  }

  void write_provenance() {
    Provenance temperature;
    temperature.emplace_back("program", ProvenanceValue{std::string("pcor " PCOR_VERSION)});
    temperature.emplace_back("method", ProvenanceValue{std::string("likelihood of heights by GPS")});
    temperature.emplace_back("slope_of_isobars", ProvenanceValue{std::string(name_of(options_.slope))});
    ProvenanceList flights;
    for (const FlightHeights& flight : result_.flights) {
      if (flight.left_out.empty()) flights.emplace_back(ProvenanceValue{flight.flight});
    }
    temperature.emplace_back("flights", ProvenanceValue{std::move(flights)});
    temperature.emplace_back("samples", ProvenanceValue{static_cast<std::int64_t>(result_.samples)});
    temperature.emplace_back("sigma_m", ProvenanceValue{result_.likelihood.sigma});
    temperature.emplace_back("pressure_error_hpa", ProvenanceValue{result_.pressure_error});
    Provenance& all = result_.model.provenance;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [](const auto& entry) { return entry.first == "temperature"; }),
              all.end());
    all.emplace_back("temperature", ProvenanceValue{std::move(temperature)});
  }

  const ModelFile& model_;
  ModelFile bare_;  // without a correction of the temperature
  const TemperatureOptions& options_;
  std::size_t threads_ = 1;
  HeightPrior prior_;
  std::vector<HeightRecord> records_;
  std::vector<HeightRecord> levelled_;  // with an estimate of the slope of isobars taken off
  MostLikely likeliest_;
  std::size_t terms_ = 1;
  TemperatureResult result_;
};

}  // namespace

std::string_view name_of(IsobarSlope slope) {
  return std::find_if(slope_names.begin(), slope_names.end(),
                      [slope](const auto& each) { return each.first == slope; })
      ->second;
}

std::optional<IsobarSlope> isobar_slope_named(std::string_view name) {
  for (const auto& [slope, slope_name] : slope_names) {
    if (slope_name == name) return slope;
  }
  return std::nullopt;
}

TemperatureResult fit_temperature(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                                  const TemperatureOptions& options) {
  if (flights.empty()) throw Error("nothing to fit the temperature to; give at least one flight");
  constexpr int most = static_cast<int>(calibration_terms) - 1;
  if (options.degree && (*options.degree < 0 || *options.degree > most))
    throw Error(fmt::format("a correction has no degree {}; give one from 0 to {}", *options.degree, most));
  return TemperatureCalibration(model, options).run(flights);
}

}  // namespace pcor
