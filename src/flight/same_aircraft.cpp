#include <pcor/flight/same_aircraft.hpp>

#include <fmt/format.h>
#include <sys/stat.h>

#include <set>

#include <pcor/words/error.hpp>

namespace pcor {

void require_one_aircraft(const std::vector<std::pair<std::string, std::string>>& flight_and_aircraft) {
  const std::pair<std::string, std::string>* first = nullptr;
  for (const auto& each : flight_and_aircraft) {
    if (each.second.empty()) continue;
    if (first == nullptr) first = &each;
    if (each.second == first->second) continue;
    throw Error(fmt::format(
        "{} is of the aircraft '{}' and {} of '{}': a model is of one aircraft; give the flights of one",
        first->first, first->second, each.first, each.second));
  }
}

void require_each_once(const std::vector<std::filesystem::path>& paths) {
  std::set<std::pair<dev_t, ino_t>> files;
  for (const std::filesystem::path& path : paths) {
    struct stat file {};
    if (stat(path.c_str(), &file) != 0 || files.emplace(file.st_dev, file.st_ino).second) continue;
    throw Error(fmt::format(
        "{} is given twice: its samples are not new ones; give every flight once, to the fit or to --holdout",
        path.string()));
  }
}

}  // namespace pcor
