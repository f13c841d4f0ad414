#pragma once

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcor::test {

/// Reference values of NCAR nimbus by column, see data/reference/README.md.
class ReferenceTable {
 public:
  ReferenceTable() {
    const std::string path = PCOR_SOURCE_DIR "/data/reference/nimbus-derived.csv";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot open " + path);
    std::string line;
    std::getline(file, line);
    const std::vector<std::string> names = fields(line);
    while (std::getline(file, line)) {
      const std::vector<std::string> values = fields(line);
      if (values.size() != names.size()) throw std::runtime_error("a short line in " + path);
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == "regime") {
          is_gv_.push_back(values[i] == "GV");
        } else {
          columns_[names[i]].push_back(std::strtod(values[i].c_str(), nullptr));
        }
      }
    }
  }

  std::size_t rows() const { return is_gv_.size(); }
  bool is_gv(std::size_t row) const { return is_gv_[row]; }
  double at(const std::string& column, std::size_t row) const { return columns_.at(column)[row]; }

 private:
  static std::vector<std::string> fields(const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) result.push_back(field);
    return result;
  }

  std::map<std::string, std::vector<double>> columns_;
  std::vector<bool> is_gv_;
};

}  // namespace pcor::test
