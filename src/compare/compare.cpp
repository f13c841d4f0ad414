#include <pcor/compare/compare.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight_writer.hpp>

#include "base/phrasing.hpp"
#include "campaign/circular_pressure.hpp"
#include "campaign/gps_system.hpp"
#include "campaign/reference_uncertainty.hpp"
#include "campaign/whitened.hpp"
#include "compare/model_sums.hpp"
#include "numerics/binned_residual.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"
#include "report/shown_flights.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor {

using namespace internal;

namespace {

std::vector<double> total_pressure(const ModelSamples& samples) {
  std::vector<double> total = *samples.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.find(Quantity::dynamic_pressure);
  for (std::size_t i = 0; i < q.size(); ++i) total[i] += q[i];
  return total;
}

/// The noise of a flight is common to all models: the model with the lowest noise determines it.
NoiseFloor min_noise(const FlightResiduals& flight) {
  std::vector<NoiseFloor> noise;
  for (const std::vector<double>& values : flight.values)
    noise.push_back(noise_of_flight(*flight.samples, values));
  return *std::min_element(noise.begin(), noise.end(),
                           [](const NoiseFloor& a, const NoiseFloor& b) { return a.rms < b.rms; });
}

/// Compared model and one of its references.
struct Pairing {
  const ComparedModel* compared;
  const Reference* reference;
  std::size_t rank;  // position of the model in the order of names
};

/// All models that have one reference, in the order in which they are given.
struct Field {
  std::string name;        // name of the reference
  std::size_t number = 0;  // index among the references with this name of one model
  std::vector<Pairing> pairings{};
};

/// Models by reference; first those with the first reference of the first model by name.
std::vector<Field> fields_of(const std::vector<ComparedModel>& models) {
  // Ranked by name and content, so that results do not depend on the order of the options.
  std::vector<std::tuple<std::string, std::string, const ComparedModel*>> ranked;
  for (const ComparedModel& each : models) ranked.emplace_back(each.name, write_model(each.model), &each);
  std::sort(ranked.begin(), ranked.end());
  std::vector<Field> fields;
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) {
    const ComparedModel& model = *std::get<const ComparedModel*>(ranked[rank]);
    std::map<std::string, std::size_t> met;
    for (const std::shared_ptr<const Reference>& reference : model.references) {
      const std::string name = reference->name();
      const std::size_t number = met[name]++;
      auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& each) {
        return each.name == name && each.number == number;
      });
      if (field == fields.end()) field = fields.insert(field, {name, number});
      field->pairings.push_back({&model, reference.get(), rank});
    }
  }
  for (Field& field : fields) {
    // In the order in which the models are given.
    std::sort(field.pairings.begin(), field.pairings.end(),
              [](const Pairing& a, const Pairing& b) { return a.compared < b.compared; });
  }
  return fields;
}

/// The pairings by rank. The first one gives the quantities with a single value for all, like the Mach number
/// of a band.
std::vector<std::size_t> by_rank(const std::vector<Pairing>& pairings) {
  std::vector<std::size_t> order(pairings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return pairings[a].rank < pairings[b].rank; });
  return order;
}

/// The residuals of models to one reference on one flight, at samples at which all models have one.
/// @param samples_of each pairing
FlightResiduals residuals_on(const std::vector<std::shared_ptr<const FlightSamples>>& samples_of,
                             const std::vector<Pairing>& pairings, const MaskOptions& options, Notes& notes) {
  FlightResiduals result;
  for (auto* const series :
       {&result.values, &result.reference_defects, &result.model_defects, &result.corrected_pressures})
    series->resize(pairings.size());
  for (const std::size_t k : by_rank(pairings)) {
    const Reference& reference = *pairings[k].reference;
    const std::shared_ptr<const FlightSamples>& samples = samples_of[k];
    const Residuals residuals(samples, pairings[k].compared->model, reference, options);
    const double* const parameters = residuals.parameters().data();
    result.values[k] = residuals.values(parameters);
    result.reference_defects[k] = residuals.target_defect(parameters);
    result.model_defects[k] = residuals.quantity(Quantity::static_defect, parameters);
    result.corrected_pressures[k] = residuals.quantity(Quantity::corrected_static_pressure, parameters);
    notes.insert(notes.end(), samples->notes.begin(), samples->notes.end());
    if (!result.samples) {
      result.samples = samples;
      result.mask = residuals.mask();
      result.static_pressure = residuals.quantity(Quantity::static_pressure, parameters);
      result.mach = residuals.quantity(Quantity::corrected_mach, parameters);
      const std::vector<double> q = residuals.quantity(Quantity::dynamic_pressure, parameters);
      result.dynamic_ratio.resize(q.size());
      for (std::size_t i = 0; i < q.size(); ++i) result.dynamic_ratio[i] = q[i] / result.static_pressure[i];
      result.total_pressure = total_pressure(samples->model);
      if (reference.model() != nullptr) result.reference_total_pressure = total_pressure(samples->reference);
    } else {
      for (std::size_t i = 0; i < result.mask.size(); ++i) {
        if (result.mask[i] == Mask::none) result.mask[i] = residuals.mask()[i];
      }
    }
  }
  for (std::vector<double>& values : result.values) {
    result.flaps_out.push_back(masked(values, result.mask, Mask::flaps));
    values = masked(values, result.mask, Mask::none);
  }
  return result;
}

/// Result of one flight, shared between ranks.
struct FlightPart {
  std::string name{};
  double begin = 0.0;  // s since 1970 UTC
  std::vector<Interval> intervals{};
  std::vector<ModelSums> models{};
  std::array<std::size_t, mask_count> masks{};
  PairMoments total_pressures{};  // first model by name, and reference
  Notes notes{};
  std::optional<FlightResiduals> series{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, begin, intervals, models, masks, total_pressures, notes, series);
  }
};

/// @param records receives the records of each model
FlightPart part_of(FlightResiduals flight, bool with_series, std::vector<SummedRecords>& records) {
  FlightPart part;
  part.name = flight.samples->name;
  part.begin = flight.samples->time.front();
  part.intervals = flight.samples->intervals;
  const NoiseFloor noise = min_noise(flight);
  records.resize(flight.values.size());
  for (std::size_t m = 0; m < flight.values.size(); ++m)
    part.models.push_back(sums_of(flight, m, noise, records[m]));
  for (std::size_t i = 0; i < flight.mask.size(); ++i) {
    ++part.masks[static_cast<std::size_t>(flight.mask[i])];
    if (flight.mask[i] != Mask::none) continue;
    if (!flight.reference_total_pressure.empty())
      part.total_pressures.add(flight.total_pressure[i], flight.reference_total_pressure[i]);
  }
  if (with_series) part.series = std::move(flight);
  return part;
}

/// Flights that a report shows.
std::vector<std::size_t> to_show(const std::vector<FlightPart>& parts, std::size_t maximum) {
  std::vector<FlightToShow> flights;
  for (const FlightPart& part : parts) {
    FlightToShow& flight = flights.emplace_back();
    flight.begin = part.begin;
    for (const ModelSums& model : part.models) flight.failure += model.all.statistics().rms;
  }
  return flights_to_show(flights, maximum);
}

/// The entries with these numbers.
template <class Entry>
std::vector<Entry> entries_of(const std::vector<Entry>& all, const std::vector<std::size_t>& numbers) {
  std::vector<Entry> some;
  for (const std::size_t number : numbers) some.push_back(all[number]);
  return some;
}

NoiseFlight noise_flight_of(const Binning& bins) {
  return {bins.size() > 0 ? bins.time().front() : 0.0, bins.size()};
}

/// Adds the variances by the noise to the sums of one model. The drift components are common to all flights,
/// from at most six of them; the level is the level of each flight.
/// @param records of the flights of this rank, for each model
void add_variances(std::size_t model, const FlightPartition& partition,
                   const std::vector<std::vector<SummedRecords>>& records, std::vector<FlightPart>& parts) {
  BinnedFlights flights;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    static const BinnedResidual none;
    const BinnedResidual& residual = partition.is_local(f) ? records[f][model].residual : none;
    flights.bins.push_back(residual.bins());
    flights.residuals.push_back(residual.means());
    flights.reference.push_back(0);
  }
  flights.outlines = partition.all_gather_flights<NoiseFlight>(
      [&](std::size_t f) { return noise_flight_of(flights.bins[f]); });
  ResidualSums all;
  for (const FlightPart& part : parts) all.add(part.models[model].all);
  const double mean = all.statistics().mean;
  BinnedFit fit;
  fit.columns = [&](std::size_t f) { return Eigen::MatrixXd::Ones(flights.residuals[f].size(), 1); };
  fit.residual = [&](std::size_t f) { return (flights.residuals[f].array() - mean).matrix(); };
  const std::vector<NoiseModel> noise = noise_of_flights(
      partition, flights, fit, [&partition](const auto& bins, const auto& columns, const auto& residuals) {
        constexpr std::size_t enough = 6;
        std::vector<NoiseFlight> outlines;
        for (const Binning& binning : bins) outlines.push_back(noise_flight_of(binning));
        const std::vector<std::size_t> few = flights_for_noise(outlines, enough);
        return expected_noise(entries_of(bins, few), entries_of(columns, few), entries_of(residuals, few),
                              partition.threads());
      });
  const auto variances = partition.map<std::vector<double>>(
      partition.threads(), [](std::size_t f) { return f; },
      [&](std::size_t f, std::size_t) {
        const SummedRecords& summed = records[f][model];
        std::vector<double> result;
        for (const std::vector<std::size_t>& part : summed.parts)
          result.push_back(part.empty() ? 0.0 : summed.residual.variance_of_sum(part, noise[f]));
        return result;
      });
  for (std::size_t f = 0; f < parts.size(); ++f) {
    auto variance = variances[f].begin();
    parts[f].models[model].each_part([&](ResidualSums& part) { part.sum_variance = *variance++; });
  }
}

/// Adds the products from which the mean residuals against wind and height follow.
void separate_atmosphere(const Pairing& pairing, const FlightSamples& samples,
                         const std::vector<std::vector<std::size_t>>& parts, ModelSums& sums) {
  const std::optional<GpsKind> kind = gps_kind(*pairing.reference);
  if (!kind || parts.front().empty()) return;
  std::vector<Eigen::MatrixXd> products =
      gps_products_of_parts(*kind, samples, pairing.compared->model, parts.front(), parts);
  if (products.empty()) return;
  auto next = products.begin();
  sums.each_part([&](ResidualSums& part) { part.by_gps = std::move(*next++); });
}

/// Compares models with a reference. Without samples the result has no models.
Comparison compare_with(const std::vector<Pairing>& pairings, const FlightSet& flights,
                        const CompareOptions& options, const std::function<void()>& report_progress) {
  const Reference& first = *pairings[by_rank(pairings).front()].reference;
  Comparison result;
  result.reference = first.description();
  result.is_static_pressure = first.is_static_pressure();
  using SamplesOfPairings = std::vector<std::shared_ptr<const FlightSamples>>;
  const auto read = [&](std::size_t number) {
    SamplesOfPairings samples;
    for (const Pairing& each : pairings)
      samples.push_back(flights.samples(number, each.compared->model, *each.reference, options.mask));
    return samples;
  };
  std::vector<ReferenceUncertainty> uncertainties;
  for (const Pairing& each : pairings)
    uncertainties.emplace_back(each.compared->model, *each.reference, !each.reference->is_of_one_sample());
  const auto make = [&](const SamplesOfPairings& samples, bool with_series,
                        std::vector<SummedRecords>& records) {
    Notes notes;
    FlightPart part = part_of(residuals_on(samples, pairings, options.mask, notes), with_series, records);
    part.notes = std::move(notes);
    for (std::size_t m = 0; m < pairings.size(); ++m) {
      part.models[m].by_uncertainty =
          uncertainties[m].columns(samples[m], records[m].parts.front()).colwise().sum();
    }
    return part;
  };
  const bool keeps_all = flights.size() <= options.max_series;
  std::vector<std::vector<SummedRecords>> records(flights.size());
  auto parts = flights.partition().map<FlightPart>(
      flights.partition().threads(),
      [&](std::size_t number) {
        report_progress();
        return read(number);
      },
      [&](std::size_t number, const SamplesOfPairings& samples) {
        FlightPart part = make(samples, keeps_all, records[number]);
        for (std::size_t m = 0; m < pairings.size() && options.separates_atmosphere; ++m)
          separate_atmosphere(pairings[m], *samples[m], records[number][m].parts, part.models[m]);
        return part;
      });
  std::vector<FlightNote> notes;
  PairMoments total_pressures;
  for (FlightPart& part : parts) {
    for (const Note& note : part.notes) notes.emplace_back(part.name, note);
    for (const Interval& interval : part.intervals) result.intervals.emplace_back(part.name, interval);
    for (std::size_t m = 0; m < mask_count; ++m) result.masks[m] += part.masks[m];
    total_pressures.add(part.total_pressures);
    if (part.series) result.flights.push_back(std::move(*part.series));
  }
  result.notes = notes_of_flights(notes, flights.size());
  if (result.masks[0] == 0) return result;
  for (std::size_t m = 0; m < pairings.size(); ++m) {
    const auto& [compared, reference, rank] = pairings[m];
    const std::string static_variable = compared->model.variable_of(Quantity::static_pressure);
    const std::string circular = circular_pressure(flights, compared->model, *reference);
    if (reference->model() != nullptr && !circular.empty() && circular == static_variable) {
      result.notes.push_back(warning_note(
          fmt::format("give a reference with another static pressure: {} uses {}, as the model "
                      "does; the residual of '{}' is the difference of two laws and does not test it",
                      reference->name(), static_variable, compared->name)));
    }
    add_variances(m, flights.partition(), records, parts);
    ModelSums sums;
    std::vector<PartStatistics> of_flights;
    for (const FlightPart& part : parts) sums.add(part.models[m]);
    const bool is_determined = sums.all.determines_level();
    for (const FlightPart& part : parts)
      of_flights.push_back({part.name, part.models[m].all.statistics(is_determined)});
    result.models.push_back(
        comparison_of(compared->name, *reference, std::move(sums), std::move(of_flights)));
    result.models.back().is_circular = !circular.empty();
  }
  if (total_pressures.samples > 0) result.total_pressure = ordinary_fit(total_pressures);
  if (keeps_all) return result;
  const std::vector<std::size_t> shown = to_show(parts, options.max_series);
  for (FlightPart& part :
       flights.partition().of_entries(shown).all_gather_flights<FlightPart>([&](std::size_t k) {
         std::vector<SummedRecords> not_needed;
         return make(read(shown[k]), true, not_needed);
       }))
    result.flights.push_back(std::move(*part.series));
  return result;
}

}  // namespace

Comparison compare(const FlightSet& flights, const std::vector<ComparedModel>& models,
                   const CompareOptions& options) {
  if (flights.empty() || models.empty())
    throw Error(Error::Code::usage, "give at least one flight to compare and one model");
  for (const ComparedModel& compared : models) first_of(compared.references);
  const std::vector<Field> fields = fields_of(models);
  flights.require_one_aircraft();
  const std::function<void()> report_progress = [&, done = std::size_t{0}]() mutable {
    ++done;
    if (options.progress) options.progress(done, fields.size() * flights.partition().local_count());
  };
  Comparison result = compare_with(fields.front().pairings, flights, options, report_progress);
  if (result.masks[0] == 0) {
    throw Error(
        Error::Code::samples,
        fmt::format("{}: no samples remain to compare: {}; see the variables of the model and "
                    "--min-airspeed, --max-flaps, --exclude, --intervals",
                    flights.size() == 1 ? flights.path(0).string() : "the flights", mask_text(result.masks)));
  }
  for (auto field = fields.begin() + 1; field != fields.end(); ++field) {
    Comparison further = compare_with(field->pairings, flights, options, report_progress);
    if (further.masks[0] == 0) {
      result.notes.push_back(fmt::format("no samples remain to compare with the {}: {}", further.reference,
                                         mask_text(further.masks)));
      continue;
    }
    result.notes.insert(result.notes.end(), further.notes.begin(), further.notes.end());
    result.further.push_back(std::move(further));
  }
  flights.require_unchanged();
  std::sort(result.notes.begin(), result.notes.end());
  result.notes.erase(std::unique(result.notes.begin(), result.notes.end()), result.notes.end());
  return result;
}

double ModelComparison::noise_ratio() const { return is_by_gps() ? nan : all.rms_over_noise(); }

std::vector<std::string> model_labels(const Comparison& comparison) {
  constexpr std::size_t max_name = 32;
  const std::vector<ModelComparison>& models = comparison.models;
  const bool are_numbered =
      models.size() > 1 && std::any_of(models.begin(), models.end(), [](const ModelComparison& model) {
        return model.name.size() > max_name;
      });
  std::vector<std::string> labels;
  for (const ModelComparison& model : models)
    labels.push_back(are_numbered ? fmt::format("model {}", labels.size() + 1) : model.name);
  return labels;
}

const ModelComparison& worst_by_noise(const Comparison& comparison, const ModelComparison& first) {
  const ModelComparison* worst = &first;
  for (const Comparison& further : comparison.further) {
    for (const ModelComparison& model : further.models) {
      if (model.name != first.name || model.is_by_gps()) continue;
      if (worst->is_by_gps() || model.noise_ratio() > std::fmax(worst->noise_ratio(), 0.0)) worst = &model;
    }
  }
  return *worst;
}

void write_residuals(const Comparison& comparison, std::size_t number, const Flight& input,
                     const std::filesystem::path& output, const std::string& history) {
  const FlightResiduals& residuals = comparison.flights.at(number);
  FileDescription description;
  description.history = history;
  description.title = "Residuals of pressure corrections, reference: " + comparison.reference;
  FlightWriter writer(output, input, description);
  std::vector<std::pair<std::size_t, std::vector<double>>> columns;
  const auto define = [&](const std::string& name, const std::string& long_name, std::vector<double> values) {
    OutputVariable variable;
    variable.name = name;
    variable.units = "hPa";
    variable.long_name = long_name;
    variable.category = "Aircraft State";
    columns.emplace_back(writer.define(variable), std::move(values));
  };
  for (std::size_t m = 0; m < residuals.values.size(); ++m) {
    const std::string& model = comparison.models[m].name;
    define(fmt::format("RESIDUAL_{}", m + 1),
           comparison.is_static_pressure
               ? fmt::format("Static pressure of {} minus static pressure of the model {}",
                             comparison.reference, model)
               : fmt::format("Residual of {}, reference minus model {}", comparison.reference, model),
           residuals.values[m]);
    define(fmt::format("PCOR_{}", m + 1), fmt::format("Static defect (delta-p) of the model {}", model),
           residuals.model_defects[m]);
    define(fmt::format("PCOR_REFERENCE_{}", m + 1),
           comparison.is_static_pressure
               ? fmt::format("Static defect (delta-p) that the reference implies for the model {}", model)
               : fmt::format("Static defect (delta-p) of the model {} plus residual of {}", model,
                             comparison.reference),
           residuals.reference_defects[m]);
  }

  const auto flags = [&](const std::string& name, const std::string& long_name, std::vector<Flag> meanings,
                         std::vector<double> values) {
    OutputVariable variable;
    variable.name = name;
    variable.long_name = long_name;
    variable.standard_name = "status_flag";
    variable.category = "Housekeeping";
    variable.flags = std::move(meanings);
    columns.emplace_back(writer.define(variable), std::move(values));
  };
  std::vector<Flag> mask_flags;
  for (std::size_t i = 1; i < mask_count; ++i)
    mask_flags.push_back({1 << (i - 1), std::string(mask_info[i].name)});
  std::vector<double> masks;
  for (const Mask mask : residuals.mask)
    masks.push_back(mask == Mask::none ? 0.0 : static_cast<double>(1 << (static_cast<int>(mask) - 1)));
  flags("MASK", "Reason why a sample is excluded from the comparison", std::move(mask_flags),
        std::move(masks));
  std::vector<Flag> regime_flags;
  for (std::size_t i = 0; i < regime_count; ++i) {
    std::string name(regime_info[i].name);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
    regime_flags.push_back({1 << i, std::move(name)});
  }
  std::vector<double> regimes;
  for (const RegimeSet& set : regimes_of_samples(residuals.samples->time, residuals.samples->intervals))
    regimes.push_back(static_cast<double>(set.to_ulong()));
  flags("REGIME", "Flight regimes and manoeuvres", std::move(regime_flags), std::move(regimes));
  const RecordBlock all{0, residuals.samples->time.size()};
  for (const auto& [variable, values] : columns) writer.write(variable, all, values.data());
  writer.finish();
}

}  // namespace pcor
