#pragma once

#include <Eigen/Dense>
#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>
#include <istream>
#include <sstream>
#include <streambuf>
#include <string>

namespace cereal {

/// Matrices and vectors, with their sizes.
template <class Archive, class Number, int rows, int columns>
void save(Archive& archive, const Eigen::Matrix<Number, rows, columns>& matrix) {
  archive(matrix.rows(), matrix.cols());
  archive(binary_data(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Number)));
}

template <class Archive, class Number, int rows, int columns>
void load(Archive& archive, Eigen::Matrix<Number, rows, columns>& matrix) {
  Eigen::Index height = 0;
  Eigen::Index width = 0;
  archive(height, width);
  matrix.resize(height, width);
  archive(binary_data(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Number)));
}

}  // namespace cereal

namespace pcor::internal {

/// A value as bytes, for another rank, which runs the same program on a processor of the same kind.
template <class Value>
std::string serialized(const Value& value) {
  std::ostringstream stream;
  cereal::BinaryOutputArchive archive(stream);
  archive(value);
  return stream.str();
}

/// Reads serialized values one after another, out of bytes that stay where they are.
class Deserializer {
 public:
  explicit Deserializer(const std::string& bytes) : buffer_(bytes) {}

  template <class Value>
  Value next() {
    Value value{};
    archive_(value);
    return value;
  }

 private:
  struct Buffer : std::streambuf {
    explicit Buffer(const std::string& bytes) {
      char* const begin = const_cast<char*>(bytes.data());  // the stream only reads
      setg(begin, begin, begin + bytes.size());
    }
  };

  Buffer buffer_;
  std::istream stream_{&buffer_};
  cereal::BinaryInputArchive archive_{stream_};
};

template <class Value>
Value deserialized(const std::string& bytes) {
  return Deserializer(bytes).next<Value>();
}

}  // namespace pcor::internal
