#include "flight/netcdf_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>

#include "base/quoting.hpp"

using netCDF::NcDim;
using netCDF::NcVar;

namespace pcor::internal {

NetcdfOutput::NetcdfOutput(const std::filesystem::path& path, const std::filesystem::path& shown_path,
                           NetcdfFormat kind)
    : NetcdfFile(shown_path, kind) {
  attempt("cannot be created", [&] { file_.create(path, kind, classic_buffer_bytes); });
  attempt("cannot be written", [&] {
    int before = 0;
    file_.set_Fill(NC_NOFILL, &before);  // every value is written
    time_ = file_.addDim("Time");
  });
}

Error NetcdfOutput::error_of(int status, const std::string& message) const {
  if (status == NC_EBADNAME || status == NC_EMAXNAME)
    return {Error::Code::output, message + "; give it another name"};
  std::error_code code;
  const auto space = std::filesystem::space(std::filesystem::absolute(path()).parent_path(), code);
  constexpr std::uintmax_t little = 1 << 20;
  const bool full = status == ENOSPC || (!code && space.available < little);
  if (!full) return {Error::Code::output, message + "; check the space and the permissions there"};
  return {Error::Code::output,
          message + (status == ENOSPC ? "" : " (the disk is full)") + "; make room or choose another output"};
}

bool NetcdfOutput::has_other_length(const std::string& dimension, std::size_t length) const {
  const NcDim known = file_.getDim(dimension);
  return !known.isNull() && known.getSize() != length;
}

NcDim NetcdfOutput::dimension_of(const std::string& name, std::size_t length) {
  const NcDim known = file_.getDim(name);
  if (known.isNull())
    return attempt("cannot have a dimension called " + quote(name),
                   [&] { return file_.addDim(name, length); });
  if (known.getSize() != length)
    refuse(Error::Code::variable, ": the dimension {} has two lengths, {} and {}; omit one of the variables",
           name, length, known.getSize());
  return known;
}

std::vector<NcDim> NetcdfOutput::dimensions_of_series(std::size_t rate) {
  if (rate == 1) return {time_};
  return {time_, dimension_of(fmt::format("sps{}", rate), rate)};
}

int NetcdfOutput::add_variable(const std::string& name, netCDF::NcType type,
                               const std::vector<NcDim>& dimensions) {
  const NcVar variable = attempt("cannot have a variable called " + quote(name),
                                 [&] { return file_.addVar(name, type, dimensions); });
  if (!is_hdf5() || dimensions.empty() || dimensions.front() != time_) return variable.getId();
  // A thousand records a chunk, and no more of them in memory than a block needs.
  constexpr std::size_t max_elements = 1 << 16, max_records = records_per_block / 4, slots = 101;
  std::vector<std::size_t> chunk{1};
  for (std::size_t i = 1; i < dimensions.size(); ++i)
    chunk.push_back(std::max<std::size_t>(dimensions[i].getSize(), 1));
  chunk[0] = std::clamp<std::size_t>(max_elements / elements(chunk), 1, max_records);
  variable.setChunking(NcVar::nc_CHUNKED, chunk);
  variable.setChunkCache(2 * elements(chunk) * type.getSize(), slots, 1);
  return variable.getId();
}

void NetcdfOutput::put_text(int number, const std::string& name, const std::string& text) const {
  if (!text.empty()) variable(number).putAtt(name, text);
}

void NetcdfOutput::drop(int number, const std::string& attribute) const {
  if (find_attribute(number, attribute)) remove_attribute(variable(number), attribute);
}

}  // namespace pcor::internal
