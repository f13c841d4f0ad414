#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcor::internal {

/// An open netCDF file: the netCDF C library behind errors of ours. Private to the reader and the writer.
class NetcdfFile {
 public:
  /// Opens for reading. @throws Error if the file is absent, not netCDF, damaged or truncated.
  static NetcdfFile open(const std::filesystem::path& path);

  /// Creates a file, over what is there; `mode` is that of nc_create. Messages call it `shown_path`.
  static NetcdfFile create(const std::filesystem::path& path, const std::filesystem::path& shown_path,
                           int mode);

  NetcdfFile(NetcdfFile&& other) noexcept;
  NetcdfFile& operator=(NetcdfFile&&) = delete;
  ~NetcdfFile();

  int id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }

  /// @throws Error "<path>: <doing>: <reason>; <what to do>" unless `status` is NC_NOERR.
  void check(int status, const std::string& doing) const;

  /// Closes for good; errors that the library kept until now are thrown.
  void close();

  /// Has HDF5 hold two chunks of a variable in memory where they are larger than usual, so that a compressed
  /// one is not unpacked for every block of records; to be called before the first value is read.
  void fit_chunk_cache(int variable) const;

  std::optional<int> find_variable(const std::string& name) const;
  std::string variable_name(int variable) const;
  std::vector<int> dimensions_of(int variable) const;
  std::string dimension_name(int dimension) const;
  std::size_t dimension_length(int dimension) const;
  int type_of(int variable) const;

  /// The names of a variable's attributes, or with NC_GLOBAL of the file's, in their order.
  std::vector<std::string> attribute_names(int variable) const;

  /// An attribute as text: trailing NULs and blanks are cut off, numbers are joined by ", ". Empty if absent.
  std::string text_attribute(int variable, const std::string& name) const;

  /// An attribute as numbers, also if they are stored as text. Empty if absent or not numeric.
  std::vector<double> number_attribute(int variable, const std::string& name) const;

 private:
  enum class Use { reading, writing };

  NetcdfFile(int id, std::filesystem::path path, Use use) : id_(id), path_(std::move(path)), use_(use) {}

  int id_;
  std::filesystem::path path_;
  Use use_;
};

/// What a netCDF status means in words.
std::string netcdf_reason(int status);

/// How much of a classic file the library keeps in memory, bytes. Its records lie one after the other, each
/// with all the variables, and the library moves whole buffers: a large one is slow where few bytes of each
/// record are wanted, and a walk through a block of records, variable after variable, is slow where the block
/// is larger.
constexpr std::size_t classic_buffer_bytes = std::size_t{32} << 10;

}  // namespace pcor::internal
