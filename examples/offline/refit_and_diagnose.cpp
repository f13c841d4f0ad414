// Fits a model to a flight with a laser and looks for effects that the model lacks:
// refit_and_diagnose FLIGHT.nc data/scenarios/models/c130-psfd-eq18.toml FITTED.toml
#include <cstdio>
#include <pcor/base/error.hpp>
#include <pcor/base/format_estimate.hpp>
#include <pcor/campaign/chosen_references.hpp>
#include <pcor/campaign/resolve_model.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/fit/refit.hpp>

int main(int argc, char** argv) try {
  if (argc != 4)
    return std::fprintf(stderr, "usage: refit_and_diagnose FLIGHT.nc MODEL.toml FITTED.toml\n"), 2;
  const pcor::FlightSet flights({argv[1]});
  pcor::Notes notes;
  const pcor::ModelDefinition model = pcor::resolve_model(pcor::read_model(argv[2]), flights, notes);
  const pcor::References references = pcor::read_references({}, model, flights).used;

  const pcor::RefitResult fit = pcor::refit(flights, model, references);
  for (const pcor::FittedParameter& each : fit.parameters)
    std::printf("%s = %s, unit %s\n", each.name.c_str(),
                pcor::format_estimate(each.value, each.standard_error).c_str(), each.unit.c_str());
  std::printf("rms %.3f hPa, noise %.3f hPa\n", fit.rms, fit.noise_rms);
  pcor::save_model(fit.model, argv[3], {argv[2]});

  const pcor::Diagnosis diagnosis = pcor::diagnose(flights, fit.model, references);
  for (const pcor::Finding& each : diagnosis.findings)
    std::printf("missing effect: %s, %.2f hPa, p = %.2g\n", each.effect.id.c_str(), each.rms, each.p_value);
  if (diagnosis.findings.empty()) std::printf("no missing effect\n");
} catch (const pcor::Error& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
