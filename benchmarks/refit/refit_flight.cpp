// Refits equation 20 of Cooper (2012) to synthetic flights of the GV in memory and measures the time:
//
//   refit_flight SAMPLES [--flight SAMPLES] [--threads N] [--memory MIB] [--write FOLDER]
//
// --flight is the number of samples per flight (default 36000, 10 hours at 1 Hz). The output is a line of
// JSON: seconds of the refit, peak memory of the program in MiB, and the coefficients with their standard
// errors.
// --write writes the arrays to files of 64-bit floats.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pcor/fit/refit.hpp>
#include <pcor/physics/air_data.hpp>

namespace {

struct Arguments {
  std::size_t samples = 0;
  std::size_t flight = 36000;
  std::size_t threads = 1;
  std::size_t memory = std::size_t{512} << 20U;
  std::filesystem::path folder{};
};

Arguments read_arguments(const std::vector<std::string>& given) {
  Arguments result;
  if (given.empty() || given.size() % 2 == 0)
    throw std::invalid_argument(
        "the first argument must be the number of samples, followed by pairs of option and value");
  result.samples = std::stoul(given.front());
  for (std::size_t i = 1; i < given.size(); i += 2) {
    const std::string& option = given[i];
    const std::string& value = given[i + 1];
    if (option == "--flight") {
      result.flight = std::stoul(value);
    } else if (option == "--threads") {
      result.threads = std::stoul(value);
    } else if (option == "--memory") {
      result.memory = std::stoul(value) << 20U;
    } else if (option == "--write") {
      result.folder = value;
    } else {
      throw std::invalid_argument("unknown option " + option);
    }
  }
  if (result.samples == 0 || result.flight == 0)
    throw std::invalid_argument("numbers of samples must be positive");
  return result;
}

/// Equation 20 with neutral coefficients, the start of the fit.
pcor::ModelDefinition neutral_model() {
  pcor::ModelDefinition file;
  file.model.name = "equation 20";
  file.variables = {{pcor::Quantity::static_pressure, "PSF"},
                    {pcor::Quantity::dynamic_pressure, "QCF"},
                    {pcor::Quantity::mach, "MACH"}};
  for (const char* id : {"static-constant", "static-qp", "static-mach", "static-mach2", "static-mach3"})
    file.model.effects.push_back(pcor::neutral_effect(id));
  return file;
}

/// Delta-p of equation 20, hPa.
double static_defect(double p, double q, double mach) {
  return p * (0.00696 + 0.6678 * q / p + mach * (-0.05965 + mach * (-0.2833 + mach * -0.2437)));
}

/// Flight with climb, cruise at varying speed and height, and descent. The Mach number is measured
/// independently of the pressures; otherwise equation 20 has no unique solution. The reference has the
/// scatter stated in Cooper (2012), 0.28 hPa, and 1 % outliers.
std::shared_ptr<const pcor::FlightSamples> make_flight(std::size_t samples, double begin,
                                                       std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  auto flight = std::make_shared<pcor::FlightSamples>();
  flight->name = "synthetic";
  flight->aircraft = "N677F";
  std::vector<double> static_pressure(samples);
  std::vector<double> dynamic_pressure(samples);
  std::vector<double> mach(samples);
  flight->time.resize(samples);
  std::vector<double> reference(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(samples);
    const double climbed = std::min({1.0, 6.0 * x, 6.0 * (1.0 - x)});
    const double p = 1000.0 - climbed * (720.0 + 60.0 * std::sin(25.0 * x)) + 0.05 * normal(random);
    const double flown = 0.3 + 0.45 * climbed + 0.06 * std::sin(90.0 * x) + 0.001 * normal(random);
    const double q = pcor::dynamic_pressure_from_mach(p, flown, pcor::dry_air<double>());
    const double measured = flown + 0.005 * std::sin(230.0 * x) + 0.001 * normal(random);
    const double outlier = uniform(random) < 0.01 ? 3.0 + normal(random) : 0.0;
    static_pressure[i] = p;
    dynamic_pressure[i] = q;
    mach[i] = measured;
    flight->time[i] = begin + static_cast<double>(i) + 0.5;
    reference[i] = p + static_defect(p, q, measured) + 0.28 * normal(random) + outlier;
  }
  flight->model.roles = {pcor::Quantity::static_pressure, pcor::Quantity::dynamic_pressure,
                         pcor::Quantity::mach};
  flight->model.columns.emplace_back(pcor::Quantity::static_pressure, std::move(static_pressure));
  flight->model.columns.emplace_back(pcor::Quantity::dynamic_pressure, std::move(dynamic_pressure));
  flight->model.columns.emplace_back(pcor::Quantity::mach, std::move(mach));
  flight->reference.columns.emplace_back(pcor::Quantity::corrected_static_pressure, std::move(reference));
  return flight;
}

using Flights = std::vector<std::shared_ptr<const pcor::FlightSamples>>;

Flights make_flights(const Arguments& arguments) {
  constexpr double first_begin = 1.28e9;
  std::mt19937_64 random(20);
  Flights flights;
  for (std::size_t first = 0; first < arguments.samples; first += arguments.flight) {
    const std::size_t count = std::min(arguments.flight, arguments.samples - first);
    flights.push_back(make_flight(count, first_begin + 1.5 * static_cast<double>(first), random));
  }
  return flights;
}

void write(const std::vector<double>& values, std::ofstream& out) {
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(double)));
}

void write(const Flights& flights, const std::filesystem::path& folder) {
  std::ofstream p(folder / "static_pressure.f8", std::ios::binary);
  std::ofstream q(folder / "dynamic_pressure.f8", std::ios::binary);
  std::ofstream mach(folder / "mach.f8", std::ios::binary);
  std::ofstream reference(folder / "reference.f8", std::ios::binary);
  for (std::ofstream* file : {&p, &q, &mach, &reference})
    file->exceptions(std::ios::badbit | std::ios::failbit);
  for (const auto& flight : flights) {
    write(*flight->model.find(pcor::Quantity::static_pressure), p);
    write(*flight->model.find(pcor::Quantity::dynamic_pressure), q);
    write(*flight->model.find(pcor::Quantity::mach), mach);
    write(*flight->reference.find(pcor::Quantity::corrected_static_pressure), reference);
  }
}

/// Peak memory of this program, MiB. ru_maxrss is not used, because a child inherits it from its parent.
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
  }
  return std::nan("");
}

void run(const Arguments& arguments) {
  const Flights flights = make_flights(arguments);
  if (!arguments.folder.empty()) write(flights, arguments.folder);
  const double memory_before = peak_memory();
  const pcor::ModelDefinition model = neutral_model();
  const pcor::References references{pcor::pressure_reference("REFERENCE")};
  pcor::RefitOptions options;
  options.threads = arguments.threads;
  const pcor::FlightSet set(flights, {{}, &pcor::serial_communicator(), arguments.memory});
  std::size_t passes = 0;
  options.progress = [&passes](std::size_t, std::size_t) { ++passes; };

  const auto begin = std::chrono::steady_clock::now();
  const pcor::RefitResult result = pcor::refit(set, model, references, options);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;

  std::printf("{\"samples\": %zu, \"flights\": %zu, \"seconds\": %.6f, \"passes\": %zu, ", result.samples,
              flights.size(), taken.count(), passes);
  std::printf("\"memory_before\": %.1f, \"memory\": %.1f, \"deviation\": %.17g, \"rms\": %.17g, ",
              memory_before, peak_memory(), result.bulk_rms, result.rms);
  std::printf("\"condition_number\": %.3g, \"parameters\": {", result.condition_number);
  const char* separator = "";
  for (const pcor::FittedParameter& parameter : result.parameters) {
    std::printf("%s\"%s\": [%.17g, %.17g]", separator, parameter.name.c_str(), parameter.value,
                parameter.standard_error);
    separator = ", ";
  }
  std::printf("}}\n");
}

}  // namespace

int main(int count, char** arguments) {
  try {
    run(read_arguments({arguments + 1, arguments + count}));
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "refit_flight: %s\n", failure.what());
    return 1;
  }
  return 0;
}
