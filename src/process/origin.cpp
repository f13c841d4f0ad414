#include "process/origin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <system_error>

#include <pcor/base/error.hpp>
#include "flight/flight_file.hpp"
#include "model_io/model_names.hpp"

namespace pcor::internal {
namespace {

/// Global attributes of an output with the SHA-256 of its inputs.
constexpr const char *model_hash_attribute = "pcor_model_sha256",
                     *options_hash_attribute = "pcor_options_sha256",
                     *input_hash_attribute = "pcor_input_sha256";

// Every libcrypto has SHA-256: it fails for memory.
void require(bool done) {
  if (!done) throw std::bad_alloc();
}

std::string sha256_of(std::istream& stream) {
  constexpr std::size_t bytes_at_once = std::size_t{1} << 18;
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  require(context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1);
  std::vector<char> buffer(bytes_at_once);
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || stream.gcount() > 0)
    require(EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(stream.gcount())) == 1);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  require(EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1);
  return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
}

std::string sha256_of_text(const std::string& text) {
  std::istringstream stream(text);
  return sha256_of(stream);
}

/// Names of `UncertaintyPart`, in its order.
constexpr std::array<const char*, 5> part_names{"total if stated", "total", "systematic", "random", "none"};

const char* yes_or_no(bool yes) { return yes ? "yes" : "no"; }

/// Coefficients of a model with stated standard errors: "static-qp.a2 = 0.0308 +- 0.0012; ...".
std::string coefficients_text(const ModelDefinition& model) {
  std::string text;
  for (const NamedParameter& each : named_parameters(model.model)) {
    const std::optional<double> error = model.fit(each.effect, each.number).standard_error;
    text += fmt::format("{}{} = {}{}", text.empty() ? "" : "; ", each.name,
                        model.model.effects[each.effect].parameters[each.number],
                        error ? fmt::format(" +- {:.3g}", *error) : "");
  }
  return text;
}

/// The version of the program and what of the options decides what is in an output, as a text.
std::string options_text(const ProcessOptions& options) {
  return fmt::format("pcor " PCOR_VERSION
                     "; corrected with: {}; time stamp: {}; uncertainty: {}; suffix: '{}'; all variables: "
                     "{}; hydrostatic: {}{}",
                     options.correct_with == CorrectWith::lams ? "LAMS" : "model",
                     options.timestamp_alignment == TimestampAlignment::begin ? "begin" : "middle",
                     part_names[static_cast<std::size_t>(options.uncertainty)], options.suffix,
                     yes_or_no(options.copy_all), yes_or_no(options.hydrostatic),
                     options.keep_frozen ? "; frozen sensors: kept" : "");
}

}  // namespace

std::string sha256_of_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string digits = sha256_of(stream);
  if (!stream.eof())
    throw Error(Error::Code::file, path.string() + " cannot be read; check the path and the permissions");
  return digits;
}

bool changes_no_pressure(const ModelDefinition& model, const ProcessOptions& options) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  return options.correct_with == CorrectWith::model &&
         std::all_of(effects.begin(), effects.end(), is_neutral);
}

std::vector<std::pair<std::string, std::string>> origin_attributes(const std::filesystem::path& input,
                                                                   const std::string& input_sha256,
                                                                   const ModelDefinition& model,
                                                                   const ProcessOptions& options) {
  const std::string text = write_model(model);
  const std::string chosen = options_text(options);
  return {{"pcor_model", model.model.name},
          {"pcor_model_source", model.law.source},
          {"pcor_model_aircraft", model.model.aircraft},
          {"pcor_model_coefficients", coefficients_text(model)},
          {"pcor_correction", changes_no_pressure(model, options) ? "none: the model changes no pressure"
                              : options.correct_with == CorrectWith::lams ? "LAMS"
                                                                          : "model"},
          {"pcor_model_toml", text},
          {model_hash_attribute, sha256_of_text(text)},
          {"pcor_options", chosen},
          {options_hash_attribute, sha256_of_text(chosen)},
          {"pcor_input", input.filename().string()},
          {input_hash_attribute, input_sha256}};
}

bool is_up_to_date(const std::filesystem::path& output, const std::filesystem::path& input,
                   const ModelDefinition& model, const ProcessOptions& options) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(output, code)) return false;
  try {
    const auto file = open_flight_file(output);
    const auto says = [&file](const char* attribute, const std::string& hash) {
      return file->text_attribute(FlightFile::whole_file, attribute) == hash;
    };
    return says(model_hash_attribute, sha256_of_text(write_model(model))) &&
           says(options_hash_attribute, sha256_of_text(options_text(options))) &&
           says(input_hash_attribute, sha256_of_file(input));
  } catch (const Error&) {
    // An output that cannot be compared is processed again, with its error reported.
    return false;
  }
}

}  // namespace pcor::internal
