#include "fit/fitted_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include <pcor/base/utc.hpp>
#include "model_io/covariance_blocks.hpp"
#include "model_io/model_names.hpp"
#include "model_io/sensor_uncertainty.hpp"
#include "roles/model_inputs.hpp"

namespace pcor::internal {
namespace {

constexpr const char* before_key = "before";

/// A model as an entry of the list.
Provenance entry_of(const ModelDefinition& model) {
  Provenance all;
  all.emplace_back("name", ProvenanceValue{model.model.name});
  if (const auto* const date = find_entry<std::string>(model.provenance, "date"))
    all.emplace_back("date", *date);
  if (!model.law.source.empty()) all.emplace_back("source", ProvenanceValue{model.law.source});
  return all;
}

Provenance provenance_of(const RefitResult& fit, Loss loss) {
  Provenance provenance;
  const auto add = [&provenance](const char* key, auto value) {
    provenance.emplace_back(key, ProvenanceValue{std::move(value)});
  };
  add("program", std::string("pcor " PCOR_VERSION));
  add("date", utc_text(static_cast<double>(std::time(nullptr)), "%Y-%m-%dT%H:%M:%SZ"));
  add("reference", fit.reference_text);
  if (fit.estimator != refit_estimator_of_gps) add("loss", std::string(to_string(loss)));
  ProvenanceList flights;
  for (const FlightFit& flight : fit.flights) {
    if (!flight.holdout) flights.emplace_back(flight.flight);
  }
  add("flights", std::move(flights));
  add("samples", static_cast<std::int64_t>(fit.samples));
  Provenance masks;
  for (std::size_t m = 1; m < mask_count; ++m) {
    if (fit.masks[m] > 0)
      masks.emplace_back(mask_info[m].name, ProvenanceValue{static_cast<std::int64_t>(fit.masks[m])});
  }
  add("samples_not_used", std::move(masks));
  add("rms_hpa", fit.rms);
  if (std::isfinite(fit.r_squared)) add("r2", fit.r_squared);  // undefined without variation
  return provenance;
}

}  // namespace

std::string unfitted_name(const ModelDefinition& model) {
  const std::string& name = model.model.name;
  if (find_entry<std::string>(model.provenance, "program") == nullptr)
    return name;  // name given by its author
  return name.substr(0, std::min(name.find(", fitted to "), name.find(", improved on ")));
}

void record_provenance(ModelDefinition& made, const ModelDefinition& from, const std::string& how,
                       const std::string& flights) {
  ProvenanceList before;
  if (const auto* const earlier = find_entry<ProvenanceList>(from.provenance, before_key)) before = *earlier;
  before.emplace_back(entry_of(from));
  set_entry(made.provenance, before_key, std::move(before));
  made.law.operational = false;
  made.model.name = fmt::format("{}, {} {}", unfitted_name(from), how, flights);
}

ModelDefinition fitted_model(const ModelDefinition& given, std::size_t first, const RefitResult& fit,
                             Loss loss, const std::string& flights) {
  ModelDefinition file = given;
  std::vector<std::string> held;
  std::vector<std::size_t> inside;  // indices in the covariance
  Covariance covariance;
  const std::vector<std::string>& known = fit.covariance_names;
  file.fits.resize(std::max(file.fits.size(), file.model.effects.size()));
  bool any_fitted = false;
  std::size_t p = first;
  for (const auto& [name, e, i] : named_parameters(file.model)) {
    const FittedParameter& parameter = fit.parameters[p++];
    file.model.effects[e].parameters[i] = parameter.value;
    file.fits[e].resize(file.model.effects[e].parameters.size());
    const auto in_covariance = std::find(known.begin(), known.end(), parameter.name);
    if (!parameter.fitted && in_covariance == known.end()) {
      held.push_back(name);
      continue;
    }
    if (parameter.fitted) {
      any_fitted = true;
      file.fits[e][i].standard_error.reset();
      if (!std::isfinite(parameter.standard_error)) continue;
      file.fits[e][i].standard_error = parameter.standard_error;
    }
    covariance.parameters.push_back(name);
    inside.push_back(static_cast<std::size_t>(in_covariance - known.begin()));
  }
  if (first == 0) {
    for (std::size_t k = 0; k < known.size(); ++k) {
      const bool is_parameter =
          std::any_of(fit.parameters.begin(), fit.parameters.end(),
                      [&](const FittedParameter& parameter) { return parameter.name == known[k]; });
      if (!has_default_uncertainty(known[k]) || is_parameter) continue;
      covariance.parameters.push_back(known[k]);
      inside.push_back(k);
    }
  }
  if (!any_fitted) return file;  // all parameters were fixed: the law is unchanged
  for (const std::size_t a : inside) {
    std::vector<double>& row = covariance.matrix.emplace_back();
    for (const std::size_t b : inside) row.push_back(fit.covariance[a][b]);
  }
  // Fixed parameters keep their covariance and are uncorrelated with the fitted ones.
  add_independent(covariance, part_of(file.covariance, [&held](const std::string& name) {
                    return std::find(held.begin(), held.end(), name) != held.end();
                  }));
  file.covariance = std::move(covariance);
  if (!std::isnan(fit.misfit_rms)) {  // a fit by GPS alone estimates no misfit, and keeps the stated one
    file.uncertainty.static_defect.reset();
    const double misfit = std::hypot(fit.misfit_rms, fit.between_flights);
    if (misfit > 0.0) file.uncertainty.static_defect = misfit;
    file.uncertainty.static_defect_ratio.reset();
  }
  Provenance provenance = provenance_of(fit, loss);
  provenance.emplace_back("pressures", ProvenanceValue{fitted_pressures(file)});
  // The temperature calibration is kept, because the pressures do not change it, and so are the added
  // effects.
  for (auto& entry : file.provenance) {
    if (entry.first == "temperature" || entry.first == "added") provenance.push_back(std::move(entry));
  }
  file.provenance = std::move(provenance);
  record_provenance(file, given, "fitted to", flights);
  file.law = {};
  file.law.source = "refit by pcor to " + fit.reference_text;
  file.law.rms_hpa = fit.rms;
  return file;
}

}  // namespace pcor::internal
