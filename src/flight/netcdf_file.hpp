#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/base/error.hpp>
#include "flight/classic_netcdf.hpp"
#include "flight/file_state.hpp"
#include "flight/flight_file.hpp"
#include "flight/netcdf_c.hpp"

namespace pcor::internal {

/// True where the first bytes are those of a netCDF file, classic or HDF5.
bool is_netcdf(const std::filesystem::path& path);

/// An open netCDF file, read by netcdf-cxx4, whose exceptions become those of this library.
class NetcdfFile : public FlightFile {
 public:
  /// Opens for reading. The library opens a file by its name more than once, and another program may replace
  /// or change it in between; every value is from the file as opened here, otherwise an error is thrown.
  /// @throws Error if the file is damaged or truncated.
  explicit NetcdfFile(std::filesystem::path path);
  ~NetcdfFile() override;

  NetcdfFormat kind() const { return kind_; }
  bool is_hdf5() const { return kind_ == NetcdfFormat::netcdf4 || kind_ == NetcdfFormat::netcdf4_classic; }

  /// A variable by its id. `whole_file` has the global attributes.
  netCDF::NcVar variable(int number) const { return {file_, number}; }
  netCDF::NcDim dimension(int number) const { return {file_, number}; }

  /// Runs `work`, which may throw exceptions of netcdf-cxx4.
  /// @throws Error "<path>: <doing>: <reason>; <what to do>" or std::bad_alloc.
  template <class Work>
  auto attempt(std::string_view doing, const Work& work) const {
    try {
      return work();
    } catch (const netCDF::exceptions::NcException& error) {
      fail(error, doing);
    }
  }

  /// To be called after values were read. @throws Error if the file was replaced or changed since it was
  /// opened.
  void require_unchanged() const;

  /// Sets the chunk cache of HDF5 for a variable of numbers or characters to two chunks, so that a compressed
  /// chunk is not unpacked again for every block of records. A larger cache would need too much memory, since
  /// HDF5 has one per variable. To be called before the first value is read; a second call has no effect.
  void fit_chunk_cache(int variable) const;

  /// An nc_type.
  int type_of(int variable) const;

  /// @param variable or `whole_file`. @throws Error "<path>: the attribute <name> of <variable> <why>; ..."
  [[noreturn]] void refuse_attribute(int variable, const std::string& name, const std::string& why) const;

  /// Empty if the attribute does not exist. @throws Error or std::bad_alloc if the library fails
  std::optional<Attribute> find_attribute(int variable, const std::string& name) const;

  const std::filesystem::path& path() const override { return path_; }
  std::size_t records_at_once() const override;
  int variable_count() const override;
  std::optional<int> find_variable(const std::string& name) const override;
  std::string variable_name(int variable) const override;
  std::vector<int> dimensions_of(int variable) const override;
  std::string dimension_name(int dimension) const override;
  std::size_t dimension_length(int dimension) const override;
  std::vector<std::string> attribute_names(int variable) const override;
  std::string text_attribute(int variable, const std::string& name) const override;
  std::vector<double> number_attribute(int variable, const std::string& name) const override;
  bool is_numeric(int variable) const override;
  double max_number(int variable) const override;
  std::vector<double> missing_values(int variable) const override;
  std::array<double, 2> valid_range(int variable) const override;
  std::string ignored_range(int variable) const override;
  void read(int variable, RecordBlock records, double* out) const override;

 protected:
  /// A file that is created by `file_`.
  NetcdfFile(std::filesystem::path path, NetcdfFormat kind) : path_(std::move(path)), kind_(kind) {}

  /// The error for a status of the library. @param message without what to do
  virtual Error error_of(int status, const std::string& message) const;

  std::filesystem::path path_;
  BufferedFile file_;
  NetcdfFormat kind_ = NetcdfFormat::classic;

 private:
  [[noreturn]] void fail(const netCDF::exceptions::NcException& error, std::string_view doing) const;

  /// Whether the values are unsigned integers, by their type or by the attribute _Unsigned.
  bool is_unsigned(int variable) const;

  /// Reads large records of a classic file once from the first byte to the last, so that the system has them
  /// in its memory: the library reads a piece of each, for every variable again.
  void bring_into_memory(RecordBlock records) const;

  /// Converts stored numbers to the signedness that the attribute states.
  void make_unsigned(int variable, double* numbers, std::size_t count) const;

  /// An attribute that states numbers of a variable, as `read` gives these.
  std::vector<double> stored_numbers(int variable, const std::string& name) const;

  /// Name of an item of the file. @throws Error if it is longer than netCDF allows (HDF5 allows longer
  /// names), since no function of the library finds such an item
  std::string allowed(const std::string& name, const char* what) const;

  FileState state_;                  // state of the file when it was opened for reading
  ClassicLayout layout_;             // layout of a classic file
  mutable std::size_t brought_ = 0;  // first record after those in memory
  mutable std::set<int> fitted_;     // variables whose chunk cache is fit
};

/// The product of some lengths.
std::size_t elements(const std::vector<std::size_t>& shape);

/// Text for an error of netcdf-cxx4.
std::string netcdf_reason(const netCDF::exceptions::NcException& error);

/// Buffer size of the library for a classic file, bytes, unless records are large. Each record holds all
/// variables, and the library reads whole buffers, so all variables of a block of records are read while the
/// block is in the buffer.
constexpr std::size_t classic_buffer_bytes = std::size_t{1} << 20;

/// Number of records of the given size, bytes, that fit into such a buffer; a few if records are larger.
std::size_t records_in_buffer(std::size_t record_bytes);

}  // namespace pcor::internal
