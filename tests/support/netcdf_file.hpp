#pragma once

#include <netcdf.h>

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcor::test {

inline constexpr double midnight = 1077062400;  // 2004-02-18 00:00:00 UTC

/// Writes a small netCDF file for a test: define a variable, then set its values. The destructor closes the
/// file. Uses only the C library, independently of the tested readers and writers.
class NetcdfMaker {
 public:
  explicit NetcdfMaker(const std::filesystem::path& path, int mode = NC_NETCDF4) {
    check(nc_create(path.c_str(), mode | NC_CLOBBER, &id_));
  }
  NetcdfMaker(const NetcdfMaker&) = delete;
  NetcdfMaker& operator=(const NetcdfMaker&) = delete;
  ~NetcdfMaker() { nc_close(id_); }

  int id() const { return id_; }

  /// Length 0 (NC_UNLIMITED) makes the unlimited dimension.
  int dimension(const std::string& name, std::size_t length) {
    int number = 0;
    check(nc_def_dim(id_, name.c_str(), length, &number));
    return number;
  }

  int variable(const std::string& name, int type, const std::vector<int>& dimensions) {
    int number = 0;
    check(
        nc_def_var(id_, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &number));
    return number;
  }

  /// The text is written unchanged; old writers append a NUL.
  void text(int variable, const std::string& name, const std::string& value) {
    check(nc_put_att_text(id_, variable, name.c_str(), value.size(), value.data()));
  }

  void numbers(int variable, const std::string& name, int type, const std::vector<double>& values) {
    check(nc_put_att_double(id_, variable, name.c_str(), type, values.size(), values.data()));
  }

  /// Writes all values of a variable; the number of values determines the first dimension.
  void values(int variable, const std::vector<double>& values) {
    nc_enddef(id_);
    int rank = 0, dimensions[NC_MAX_VAR_DIMS];
    check(nc_inq_var(id_, variable, nullptr, nullptr, &rank, dimensions, nullptr));
    std::vector<std::size_t> start(static_cast<std::size_t>(rank), 0), count;
    std::size_t remaining = values.size();
    for (int i = 1; i < rank; ++i) {
      std::size_t length = 0;
      check(nc_inq_dimlen(id_, dimensions[i], &length));
      remaining /= length;
      count.push_back(length);
    }
    if (rank > 0) count.insert(count.begin(), remaining);
    if (!values.empty()) {
      const int status = nc_put_vara_double(id_, variable, start.data(), count.data(), values.data());
      if (status != NC_ERANGE) check(status);  // infinities are stored too
    }
    nc_redef(id_);
  }

  /// Variable `Time` in the present form of NCAR: seconds since midnight.
  int time(const std::vector<double>& seconds,
           const std::string& units = "seconds since 2004-02-18 00:00:00 +0000", int type = NC_INT) {
    time_dimension = dimension("Time", NC_UNLIMITED);
    const int number = variable("Time", type, {time_dimension});
    if (!units.empty()) text(number, "units", units);
    values(number, seconds);
    return number;
  }

  /// Float variable over (Time), or over (Time, spsN) if the rate N exceeds 1.
  int series(const std::string& name, const std::string& units, const std::vector<double>& data,
             int rate = 1) {
    std::vector<int> dimensions{time_dimension};
    if (rate > 1) {
      const std::string sps = "sps" + std::to_string(rate);
      int number = 0;
      if (nc_inq_dimid(id_, sps.c_str(), &number) != NC_NOERR)
        number = dimension(sps, static_cast<std::size_t>(rate));
      dimensions.push_back(number);
    }
    const int number = variable(name, NC_FLOAT, dimensions);
    numbers(number, "_FillValue", NC_FLOAT, {-32767});
    if (!units.empty()) text(number, "units", units);
    values(number, data);
    return number;
  }

  int time_dimension = 0;

 private:
  static void check(int status) {
    if (status != NC_NOERR) throw std::runtime_error(nc_strerror(status));
  }

  int id_ = 0;
};

/// Writes a file with times, seconds since midnight. @param fill adds other variables
template <class Fill>
void make_flight(const std::filesystem::path& path, const std::vector<double>& seconds, const Fill& fill,
                 int mode = NC_NETCDF4) {
  NetcdfMaker maker(path, mode);
  maker.time(seconds);
  fill(maker);
}

/// `count` numbers: first, first + 1, ...
inline std::vector<double> sequence(double first, std::size_t count) {
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = first + static_cast<double>(i);
  return numbers;
}

}  // namespace pcor::test
