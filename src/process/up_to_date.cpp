#include <pcor/process/up_to_date.hpp>

#include <system_error>

#include <pcor/base/error.hpp>
#include "flight/flight_file.hpp"
#include "process/origin.hpp"
#include "process/sha256.hpp"

namespace pcor {

using namespace internal;

namespace fs = std::filesystem;

bool is_up_to_date(const fs::path& output, const fs::path& input, const ModelDefinition& model,
                   const ProcessOptions& options) {
  std::error_code code;
  if (!fs::is_regular_file(output, code)) return false;
  try {
    const auto file = open_flight_file(output);
    const auto says = [&file](const char* attribute, const std::string& hash) {
      return file->text_attribute(FlightFile::whole_file, attribute) == hash;
    };
    if (!says(model_hash_attribute, sha256_of_text(write_model(model))) ||
        !says(options_hash_attribute, sha256_of_text(options_text(options))))
      return false;
    const std::string hash = sha256_of_file(input);
    return says(input_hash_attribute, hash);
  } catch (const Error&) {
    // An output that cannot be compared is processed again, with its error reported.
    return false;
  }
}

}  // namespace pcor
