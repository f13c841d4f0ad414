#include <pcor/parallel/communicator.hpp>

#include <algorithm>
#include <new>

#include "parallel/serialization.hpp"

namespace pcor {

using namespace internal;

struct Communicator::Message {
  bool is_last = false;  // its sender leaves
  std::uint64_t state = 0;
  std::string part{};
  // Fields of an error:
  bool has_error = false;
  std::uint64_t order = 0;
  Error::Code code{};
  std::string text{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(is_last, state, part, has_error, order, code, text);
  }

  static Message of(const Error& error, std::size_t order) {
    Message message;
    message.has_error = true;
    message.order = order;
    message.code = error.code();
    message.text = error.what();
    return message;
  }

  /// Error in which a single process would have failed first.
  static const Message* first_error(const std::vector<Message>& all) {
    const Message* first = nullptr;
    for (const Message& each : all) {
      if (each.has_error && (first == nullptr || each.order < first->order)) first = &each;
    }
    return first;
  }
};

std::vector<Communicator::Message> Communicator::talk(const Message& local) {
  if (has_parted_)
    throw parted_with_ ? *parted_with_ : Error(Error::Code::system, "another process of this run has ended");
  std::vector<Message> all;
  for (const std::string& bytes : exchange(serialized(local))) all.push_back(deserialized<Message>(bytes));
  has_parted_ = std::any_of(all.begin(), all.end(), [](const Message& each) { return each.is_last; });
  if (const Message* const error = Message::first_error(all)) {
    const Error agreed(error->code, error->text);
    if (has_parted_) parted_with_ = agreed;
    throw agreed;
  }
  const bool agree = std::all_of(all.begin(), all.end(), [&all](const Message& each) {
    return each.is_last == all.front().is_last && each.state == all.front().state;
  });
  if (!agree) {
    has_parted_ = true;
    parted_with_ = Error(
        Error::Code::system,
        "processes obtained different results; use identical command lines, input files and CPU models on "
        "all nodes");
    throw *parted_with_;
  }
  return all;
}

std::vector<std::string> Communicator::all_gather(const std::string& local, std::uint64_t state) {
  if (size() == 1) return {local};
  Message message;
  message.state = state;
  message.part = local;
  std::vector<std::string> parts;
  for (Message& each : talk(message)) parts.push_back(std::move(each.part));
  return parts;
}

void Communicator::fail(const Error& error, std::size_t order) {
  if (size() > 1) talk(Message::of(error, order));
  throw error;
}

std::optional<Error> Communicator::finalize(const std::optional<Error>& error) {
  if (size() == 1) return error;
  if (has_parted_) return parted_with_ ? parted_with_ : error;
  Message last = error ? Message::of(*error, 0) : Message{};
  last.is_last = true;
  try {
    talk(last);
  } catch (const Error& of_all) {
    return of_all;
  } catch (const std::bad_alloc&) {
    return error.value_or(
        Error(Error::Code::system, "the memory is exhausted; give fewer or shorter flights at a time"));
  }
  return std::nullopt;
}

Communicator& serial_communicator() {
  static Communicator comm;
  return comm;
}

}  // namespace pcor
