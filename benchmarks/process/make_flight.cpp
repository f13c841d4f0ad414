// Writes a synthetic flight of 25 samples per second, with as many variables as a file of a jet:
//
//   make_flight classic|netcdf4 HOURS OUT.nc
#include <netcdf.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "flight.hpp"

namespace {

constexpr std::size_t rate = 25;
constexpr int other_variables = 20;

void check(int status) {
  if (status == NC_NOERR) return;
  std::fprintf(stderr, "make_flight: %s\n", nc_strerror(status));
  std::exit(1);
}

void put_text(int file, int variable, const char* name, const std::string& text) {
  check(nc_put_att_text(file, variable, name, text.size(), text.c_str()));
}

/// One variable of the file with all samples.
struct Variable {
  std::string name;
  std::string units;
  std::string long_name;
  std::vector<float> values;
  int number = 0;
};

Variable variable(const char* name, const char* units, const char* long_name,
                  const std::vector<double>& values, double offset = 0.0) {
  Variable result{name, units, long_name, {}};
  for (const double value : values) result.values.push_back(static_cast<float>(value + offset));
  return result;
}

std::vector<Variable> variables_of(std::size_t samples) {
  const pcor::benchmarks::Flight flight = pcor::benchmarks::make_flight(samples);
  std::vector<double> attack_pressure;
  std::vector<double> sideslip_pressure;
  std::vector<double> altitude;
  std::mt19937_64 random(25);
  std::normal_distribution<double> noise;
  for (std::size_t i = 0; i < samples; ++i) {
    attack_pressure.push_back(flight.dynamic_pressure[i] * (flight.attack[i] - 5.5) / 20.0);
    sideslip_pressure.push_back(flight.dynamic_pressure[i] * 0.01 * noise(random));
    altitude.push_back(44330.8 * (1.0 - std::pow(flight.static_pressure[i] / 1013.25, 0.190263)));
  }
  const double celsius = -273.15;
  std::vector<Variable> variables{
      variable("PSF", "hPa", "Raw Static Pressure, Fuselage", flight.static_pressure),
      variable("QCF", "hPa", "Raw Dynamic Pressure, Fuselage", flight.dynamic_pressure),
      variable("TTHR1", "deg_C", "Recovery Temperature", flight.recovery_temperature, celsius),
      variable("EDPC", "hPa", "Ambient Water Vapor Pressure", flight.vapor_pressure),
      variable("AKRD", "degree", "Attack Angle, Radome", flight.attack),
      variable("QCR", "hPa", "Raw Dynamic Pressure, Radome", flight.dynamic_pressure),
      variable("ADIFR", "hPa", "Vertical Differential Pressure, Radome", attack_pressure),
      variable("BDIFR", "hPa", "Horizontal Differential Pressure, Radome", sideslip_pressure),
      variable("VLAMS", "m/s", "Airspeed along the Laser Beam", flight.lams_airspeed),
      variable("GGALT", "m", "GPS Altitude", altitude)};
  for (int i = 1; i <= other_variables; ++i) {
    std::vector<double> values;
    for (std::size_t k = 0; k < samples; ++k) values.push_back(i + noise(random));
    variables.push_back(variable(("OTHER" + std::to_string(i)).c_str(), "V", "Another Variable", values));
  }
  return variables;
}

void write(const std::string& kind, std::size_t seconds, const char* path) {
  std::vector<Variable> variables = variables_of(seconds * rate);
  int file = 0;
  check(nc_create(path, kind == "netcdf4" ? NC_NETCDF4 : NC_CLOBBER, &file));
  int dimensions[2] = {};
  check(nc_def_dim(file, "Time", NC_UNLIMITED, &dimensions[0]));
  check(nc_def_dim(file, "sps25", rate, &dimensions[1]));
  int time = 0;
  check(nc_def_var(file, "Time", NC_INT, 1, dimensions, &time));
  put_text(file, time, "units", "seconds since 2014-06-01 12:00:00 +0000");
  put_text(file, time, "standard_name", "time");
  for (Variable& v : variables) {
    check(nc_def_var(file, v.name.c_str(), NC_FLOAT, 2, dimensions, &v.number));
    const float fill = -32767.0F;
    check(nc_put_att_float(file, v.number, "_FillValue", NC_FLOAT, 1, &fill));
    put_text(file, v.number, "units", v.units);
    put_text(file, v.number, "long_name", v.long_name);
    if (kind == "netcdf4") {
      const std::size_t chunk[2] = {3600, rate};
      check(nc_def_var_chunking(file, v.number, NC_CHUNKED, chunk));
    }
  }
  put_text(file, NC_GLOBAL, "Conventions", "NCAR-RAF/nimbus-2.0,CF-1.6");
  put_text(file, NC_GLOBAL, "platform", "N677F");
  put_text(file, NC_GLOBAL, "title", "Synthetic flight, not a measurement");
  check(nc_enddef(file));
  std::vector<int> times;
  for (std::size_t i = 0; i < seconds; ++i) times.push_back(static_cast<int>(i));
  const std::size_t start[2] = {0, 0};
  const std::size_t count[2] = {seconds, rate};
  check(nc_put_vara_int(file, time, start, count, times.data()));
  for (const Variable& v : variables) check(nc_put_vara_float(file, v.number, start, count, v.values.data()));
  check(nc_close(file));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: make_flight classic|netcdf4 HOURS OUT.nc\n"), 2;
  write(argv[1], static_cast<std::size_t>(3600.0 * std::atof(argv[2])), argv[3]);
}
