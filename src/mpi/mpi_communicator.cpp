#include <pcor/mpi/mpi_communicator.hpp>

#include <mpi.h>

#include <algorithm>

namespace pcor {
namespace {

/// Bytes that all members together exchange in one call: MPI counts them by a 32-bit number.
constexpr std::size_t max_at_once = std::size_t{1} << 30;

}  // namespace

MpiCommunicator::MpiCommunicator() {
  int rank = 0;
  int size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  rank_ = static_cast<std::size_t>(rank);
  size_ = static_cast<std::size_t>(size);
}

std::vector<std::string> MpiCommunicator::exchange(const std::string& own) {
  const std::uint64_t length = own.size();
  std::vector<std::uint64_t> lengths(size_);
  MPI_Allgather(&length, 1, MPI_UINT64_T, lengths.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  std::vector<std::string> all(size_);
  const std::size_t maximum = max_at_once / size_;
  const std::size_t longest = *std::max_element(lengths.begin(), lengths.end());
  for (std::size_t first = 0; first < longest; first += maximum) {
    std::vector<int> counts;
    std::vector<int> offsets;
    int end = 0;
    for (const std::uint64_t of_member : lengths) {
      const std::size_t left = of_member > first ? of_member - first : 0;
      counts.push_back(static_cast<int>(std::min(left, maximum)));
      offsets.push_back(end);
      end += counts.back();
    }
    std::string bytes(static_cast<std::size_t>(end), '\0');
    MPI_Allgatherv(own.data() + std::min(first, own.size()), counts[rank_], MPI_BYTE, bytes.data(),
                   counts.data(), offsets.data(), MPI_BYTE, MPI_COMM_WORLD);
    for (std::size_t member = 0; member < size_; ++member)
      all[member].append(bytes, static_cast<std::size_t>(offsets[member]),
                         static_cast<std::size_t>(counts[member]));
  }
  return all;
}

}  // namespace pcor
