#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor {

/// Processes of MPI_COMM_WORLD. Must exist only between MPI_Init and MPI_Finalize, which the program calls.
/// An MPI error ends the job.
class MpiCommunicator final : public Communicator {
 public:
  MpiCommunicator();

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }

 private:
  std::vector<std::string> exchange(const std::string& local) override;

  std::size_t rank_ = 0;
  std::size_t size_ = 1;
};

}  // namespace pcor
