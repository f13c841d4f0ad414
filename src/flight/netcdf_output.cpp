#include "flight/netcdf_output.hpp"

#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>

#include <pcor/words/error.hpp>
#include "words/quoting.hpp"

namespace pcor::internal {
namespace {

int creation_mode(FileKind kind) {
  switch (kind) {
    case FileKind::classic:
      return 0;
    case FileKind::offset64:
      return NC_64BIT_OFFSET;
    case FileKind::cdf5:
      return NC_64BIT_DATA;
    case FileKind::netcdf4_classic:
      return NC_NETCDF4 | NC_CLASSIC_MODEL;
    case FileKind::netcdf4:
      break;
  }
  return NC_NETCDF4;
}

}  // namespace

FileKind kind_of(const NetcdfFile& file) {
  int format = 0;
  file.check(nc_inq_format(file.id(), &format), "cannot tell its format");
  switch (format) {
    case NC_FORMAT_CLASSIC:
      return FileKind::classic;
    case NC_FORMAT_64BIT_OFFSET:
      return FileKind::offset64;
    case NC_FORMAT_CDF5:
      return FileKind::cdf5;
    case NC_FORMAT_NETCDF4_CLASSIC:
      return FileKind::netcdf4_classic;
    default:
      return FileKind::netcdf4;
  }
}

NetcdfOutput::NetcdfOutput(const std::filesystem::path& path, const std::filesystem::path& shown_path,
                           FileKind kind)
    : file_(NetcdfFile::create(path, shown_path, creation_mode(kind))),
      is_hdf5_(kind == FileKind::netcdf4 || kind == FileKind::netcdf4_classic) {
  int before = 0;
  check(nc_set_fill(id(), NC_NOFILL, &before));  // every value is written
  check(nc_def_dim(id(), "Time", NC_UNLIMITED, &time_dimension_));
}

bool NetcdfOutput::has_other_length(const std::string& dimension, std::size_t length) const {
  const auto known = dimensions_.find(dimension);
  return known != dimensions_.end() && file_.dimension_length(known->second) != length;
}

int NetcdfOutput::dimension(const std::string& name, std::size_t length) {
  if (has_other_length(name, length))
    throw Error(fmt::format("{}: the dimension {} has two lengths, {} and {}; leave one variable out",
                            file_.path().string(), name, length,
                            file_.dimension_length(dimensions_.at(name))));
  const auto [place, is_new] = dimensions_.emplace(name, 0);
  if (is_new)
    file_.check(nc_def_dim(id(), name.c_str(), length, &place->second),
                "cannot have a dimension called " + in_quotes(name));
  return place->second;
}

std::vector<int> NetcdfOutput::dimensions_of_series(std::size_t rate) {
  if (rate == 1) return {time_dimension_};
  return {time_dimension_, dimension(fmt::format("sps{}", rate), rate)};
}

int NetcdfOutput::add_variable(const std::string& name, int type, const std::vector<int>& dimensions) {
  int variable = 0;
  file_.check(
      nc_def_var(id(), name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &variable),
      "cannot have a variable called " + in_quotes(name));
  const bool over_time = !dimensions.empty() && dimensions.front() == time_dimension_;
  if (is_hdf5_ && over_time) store_in_chunks(variable, type, dimensions);
  return variable;
}

// A thousand records a chunk, and no more of them in memory than a block needs.
void NetcdfOutput::store_in_chunks(int variable, int type, const std::vector<int>& dimensions) const {
  constexpr std::size_t most_elements = 1 << 16, most_records = records_per_block / 4, slots = 101;
  std::vector<std::size_t> chunk{1};
  for (std::size_t i = 1; i < dimensions.size(); ++i) chunk.push_back(file_.dimension_length(dimensions[i]));
  chunk[0] = std::clamp<std::size_t>(most_elements / elements(chunk), 1, most_records);
  check(nc_def_var_chunking(id(), variable, NC_CHUNKED, chunk.data()));
  std::size_t bytes = 0;
  check(nc_inq_type(id(), type, nullptr, &bytes));
  check(nc_set_var_chunk_cache(id(), variable, 2 * elements(chunk) * bytes, slots, 1));
}

void NetcdfOutput::put_text(int variable, const std::string& name, const std::string& text) const {
  if (!text.empty()) check(nc_put_att_text(id(), variable, name.c_str(), text.size(), text.data()));
}

void NetcdfOutput::end_definition() {
  if (!is_defining_) return;
  is_defining_ = false;
  check(nc_enddef(id()));
}

void NetcdfOutput::remove(const std::vector<std::pair<int, std::string>>& attributes) const {
  if (attributes.empty()) return;
  check(nc_redef(id()));
  for (const auto& [variable, name] : attributes) check(nc_del_att(id(), variable, name.c_str()));
  check(nc_enddef(id()));
}

}  // namespace pcor::internal
