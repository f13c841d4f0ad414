#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "flight/file_state.hpp"
#include "flight/flight_file.hpp"

namespace pcor::internal {

/// True where the first bytes are those of a netCDF file, classic or HDF5.
bool is_netcdf(const std::filesystem::path& path);

/// An open netCDF file: the netCDF C library behind errors of ours.
class NetcdfFile final : public FlightFile {
 public:
  /// Opens for reading. The library opens a file by its name more than once, and another program may replace
  /// or change it meanwhile: what is read is of the file as it was here, or an error.
  /// @throws Error if the file is damaged or truncated.
  static NetcdfFile open(const std::filesystem::path& path);

  /// Creates a file, over what is there; `mode` is that of nc_create. Messages call it `shown_path`.
  static NetcdfFile create(const std::filesystem::path& path, const std::filesystem::path& shown_path,
                           int mode);

  NetcdfFile(NetcdfFile&& other) noexcept;
  NetcdfFile& operator=(NetcdfFile&&) = delete;
  ~NetcdfFile() override;

  int id() const { return id_; }

  /// @throws Error "<path>: <doing>: <reason>; <what to do>" unless `status` is NC_NOERR.
  void check(int status, const std::string& doing) const;

  /// To be called after values were read. @throws Error if the file was replaced or changed since it was
  /// opened.
  void require_unchanged() const;

  /// Closes for good; errors that the library kept until now are thrown.
  void close();

  /// Has HDF5 hold two chunks of a variable in memory, so that a compressed one is not unpacked for every
  /// block of records, and not much more, since it keeps what it read of every variable. To be called before
  /// the first value is read; a second call does nothing.
  void fit_chunk_cache(int variable) const;

  int type_of(int variable) const;

  /// @param variable or NC_GLOBAL. @throws Error "<path>: the attribute <name> of <variable> <why>; ..."
  [[noreturn]] void refuse_attribute(int variable, const std::string& name, const std::string& why) const;

  /// What an attribute is made of.
  struct Attribute {
    int type = 0;  ///< an nc_type
    std::size_t length = 0;
  };

  /// Nothing where there is no such attribute. @throws Error or std::bad_alloc where the library cannot tell
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
  double greatest_number(int variable) const override;
  std::vector<double> missing_values(int variable) const override;
  std::array<double, 2> valid_range(int variable) const override;
  void read(int variable, RecordBlock records, double* out) const override;

 private:
  /// Whether the values are unsigned integers: by their type, or because the attribute _Unsigned says so.
  bool is_unsigned(int variable) const;

  /// Reads large records of a classic file once from the first byte to the last, so that the system has them
  /// in its memory: the library reads a piece of each, for every variable again.
  void bring_into_memory(RecordBlock records) const;

  /// Turns stored numbers into those that the attribute says that they are.
  void make_unsigned(int variable, double* numbers, std::size_t count) const;

  /// An attribute that states numbers of a variable, as `read` gives these.
  std::vector<double> stored_numbers(int variable, const std::string& name) const;

  /// A name of what the file holds. @throws Error if it is longer than netCDF allows, as those that HDF5
  /// allows may be: no function of the library finds what is called so
  std::string allowed(const std::string& name, const char* what) const;

  enum class Use { reading, writing };

  NetcdfFile(int id, std::filesystem::path path, Use use, FileState state = {})
      : id_(id), path_(std::move(path)), use_(use), state_(state) {}

  int id_;
  std::filesystem::path path_;
  Use use_;
  FileState state_;  // as it was opened for reading
  // Of a classic file with records.
  std::size_t record_bytes_ = 0;
  std::size_t records_begin_ = 0;    // in bytes from that of the file
  mutable std::size_t brought_ = 0;  // behind the last record that was brought into memory
  mutable std::set<int> fitted_;     // variables whose chunk cache is fit
};

/// The product of some lengths.
std::size_t elements(const std::vector<std::size_t>& shape);

/// What a netCDF status means in words.
std::string netcdf_reason(int status);

/// How much of a classic file the library keeps in memory, bytes, but where records are large. They lie one
/// after the other, each with all the variables, and the library moves whole buffers, so that a block of
/// records is walked through variable after variable while it is in the buffer.
constexpr std::size_t classic_buffer_bytes = std::size_t{1} << 20;

/// Records of so many bytes that are in such a buffer together, or a few where they are larger.
std::size_t records_in_buffer(std::size_t record_bytes);

}  // namespace pcor::internal
