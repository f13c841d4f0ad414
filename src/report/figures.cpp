#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include <pcor/report/figures.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace pcor {

namespace fs = std::filesystem;

namespace {

constexpr const char* captions = "captions.txt";

// Program found in the variable PATH; empty if absent.
std::string program_named(const std::string& name) {
  if (name.find('/') != std::string::npos) return ::access(name.c_str(), X_OK) == 0 ? name : "";
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string file = (folder.empty() ? "." : folder) + "/" + name;
    if (::access(file.c_str(), X_OK) == 0 && !fs::is_directory(file)) return file;
  }
  return "";
}

std::string browser() {
  if (const char* const chosen = std::getenv("CHROMIUM"); chosen != nullptr && *chosen != '\0') {
    const std::string found = program_named(chosen);
    if (found.empty())
      throw Error(
          Error::Code::system,
          fmt::format(
              "figures: CHROMIUM names {}, which is not a program; set it to Chromium or a similar browser",
              chosen));
    return found;
  }
  for (const char* const name : {"chromium", "chromium-browser", "google-chrome"}) {
    if (std::string found = program_named(name); !found.empty()) return found;
  }
  throw Error(
      Error::Code::system,
      "figures: Chromium was not found; install it (on Debian: apt-get install chromium), set CHROMIUM to a "
      "similar browser, or save the pictures of a --report from a browser");
}

std::string file_address(const fs::path& path) {
  std::string address = "file://";
  for (const char letter : path.string())
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
        std::string_view("/._-").find(letter) != std::string_view::npos)
      address += letter;
    else
      address += fmt::format("%{:02X}", static_cast<unsigned char>(letter));
  return address;
}

// File in memory that holds a page, for a program that this one starts.
class PageInMemory {
 public:
  explicit PageInMemory(const std::string& html) : descriptor_(::memfd_create("page.html", 0)) {
    for (std::size_t done = 0; descriptor_ >= 0 && done < html.size();) {
      const ::ssize_t count = ::write(descriptor_, html.data() + done, html.size() - done);
      if (count < 0 && errno != EINTR)
        throw Error(Error::Code::system, "figures: there is no memory for the page of the browser");
      done += count < 0 ? 0 : static_cast<std::size_t>(count);
    }
  }
  ~PageInMemory() { ::close(descriptor_); }
  PageInMemory(const PageInMemory&) = delete;
  PageInMemory& operator=(const PageInMemory&) = delete;

  std::string path() const { return fmt::format("/dev/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

// Final content of a page. A shell makes the folder of the browser and removes it, also if this program is
// stopped at any time; a browser that hangs is killed.
std::string dumped(const std::string& program, const std::string& html, const std::string& wish) {
  constexpr int no_folder = 3;
  std::error_code code;
  const fs::path temporary = fs::absolute(fs::temp_directory_path(code), code);
  const PageInMemory page(html);
  const bool is_root = ::geteuid() == 0;  // Chromium has no sandbox for root
  const std::string command = fmt::format(
      "folder=\n"
      "trap '[ -z \"$folder\" ] || rm -rf -- \"$folder\"' EXIT; trap 'exit 1' INT TERM HUP PIPE\n"
      "folder=$(mktemp -d {0} 2> /dev/null) && cd \"$folder\" && cat {1} 2> /dev/null > page.html || exit "
      "{2}\n"
      // Chromium puts a socket into TMPDIR, and the path of a socket has at most 107 characters.
      "TMPDIR=. timeout --kill-after=5 120 {3} --headless=new {4} --disable-gpu --user-data-dir=profile "
      "--dump-dom {5}\"${{folder##*/}}\"/page.html{6} 2> messages && exit\n"
      "[ $? -eq 124 ] && echo 'it was not done after two minutes' && exit 1\n"
      "tail -n 1 messages; exit 1\n",
      shell_quote((temporary / "pcor-figures-XXXXXX").string()), page.path(), no_folder,
      shell_quote(fs::absolute(program).string()), is_root ? "--no-sandbox" : "",
      shell_quote(file_address(temporary) + "/"), shell_quote(wish));
  std::FILE* const pipe = code ? nullptr : ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 65536> buffer{};
  for (std::size_t count = 0;
       pipe != nullptr && (count = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), count);
  const int status = pipe == nullptr ? -1 : ::pclose(pipe);
  if (status == -1 || (WIFEXITED(status) && WEXITSTATUS(status) == no_folder))
    throw Error(Error::Code::output, "figures: cannot write to the folder for temporary files " +
                                         temporary.string() +
                                         "; check the space there, or set TMPDIR to another folder");
  if (status != 0) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    throw Error(
        Error::Code::system,
        fmt::format("figures: {} failed: {}; start it from a shell, or set CHROMIUM to another browser",
                    program, text.substr(text.rfind('\n') + 1)));
  }
  return text;
}

std::string decoded(const std::string& base64) {
  std::string bytes(base64.size() / 4 * 3, '\0');
  const int length =
      EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                      reinterpret_cast<const unsigned char*>(base64.data()), static_cast<int>(base64.size()));
  const auto padding = static_cast<std::size_t>(std::count(base64.begin(), base64.end(), '='));
  bytes.resize(length < 0 ? 0 : static_cast<std::size_t>(length) - padding);
  return bytes;
}

bool is_picture(const std::string& name) {
  static const std::regex pattern("[0-9]+-[a-z0-9-]+\\.(svg|png)");
  return std::regex_match(name, pattern);
}

using Files = std::vector<std::pair<std::string, std::string>>;

// Files from lines "NAME BASE64".
Files files_of(const std::string& text) {
  Files files;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    const std::string name = line.substr(0, space);
    if (space != std::string::npos && (is_picture(name) || name == captions))
      files.emplace_back(name, decoded(line.substr(space + 1)));
  }
  return files;
}

// Pictures of an earlier run, listed in its captions.
std::vector<fs::path> earlier_pictures(const fs::path& folder) {
  std::vector<fs::path> all;
  std::ifstream stream(folder / captions);
  for (std::string line; std::getline(stream, line);) {
    const std::string name = line.substr(0, line.find(':'));
    for (const char* const kind : {".svg", ".png"})
      if (is_picture(name + kind)) all.push_back(folder / (name + kind));
  }
  return all;
}

}  // namespace

void require_figures(const fs::path& folder) {
  constexpr const char* sign = "drawn";
  const std::string program = browser();
  OutputTransaction none;
  none.make_folder(folder);
  const AtomicFile probe(folder / captions);
  // Some browsers start without access: a containerized one does not read the folder of temporary files.
  if (dumped(program, fmt::format("<!DOCTYPE html><title>figures</title><p>{}", sign), "").find(sign) ==
      std::string::npos)
    throw Error(
        Error::Code::system,
        fmt::format("figures: {} cannot read a page in {}; set TMPDIR to a readable folder, or CHROMIUM to "
                    "another browser",
                    program, fs::temp_directory_path().string()));
}

std::vector<std::string> write_figures(const Report& report, const fs::path& folder, FigureUse use) {
  const std::string program = browser();
  constexpr std::array<const char*, 3> uses{"page", "column", "slide"};
  const std::string wish = std::string("#export+for=") + uses.at(static_cast<std::size_t>(use));
  const Files files = files_of(dumped(program, report_html(report), wish));
  if (files.empty())
    throw Error(Error::Code::system, fmt::format("figures: {} shows no pictures of this report", program));
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) {
    if (bytes.empty())
      throw Error(Error::Code::system, fmt::format("figures: {} wrote no picture for {}", program, name));
    names.push_back(name);
  }
  OutputTransaction together;
  together.make_folder(folder);
  for (const fs::path& path : earlier_pictures(folder)) {
    if (std::find(names.begin(), names.end(), path.filename().string()) == names.end()) together.remove(path);
  }
  for (const auto& [name, bytes] : files) AtomicFile(folder / name).write(bytes);
  together.appear();
  return names;
}

}  // namespace pcor
