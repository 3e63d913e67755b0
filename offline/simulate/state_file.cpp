#include "offline/simulate/state_file.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

// the file begins with this and the numbers of a state
constexpr std::uint64_t magic = 0x31'73'65'74'61'74'73'67;  // "gstates1"
constexpr std::uint64_t header_bytes = 2 * sizeof(std::uint64_t);

std::uint64_t read_word(std::fstream& file) {
  std::uint64_t word = 0;
  file.read(reinterpret_cast<char*>(&word), sizeof word);
  return word;
}

void write_word(std::ostream& file, std::uint64_t word) {
  file.write(reinterpret_cast<const char*>(&word), sizeof word);
}

}  // namespace

void StateFile::fail(const char* what) const { throw std::runtime_error(path_.string() + ": " + what); }

StateFile::StateFile(std::filesystem::path path, std::size_t numbers, std::uint64_t frames)
    : path_(std::move(path)), numbers_(numbers) {
  if (!std::filesystem::exists(path_)) {
    if (frames > 0) fail("missing, so the trajectories cannot go on; begin again with --overwrite");
    std::ofstream fresh(path_, std::ios::binary);
    write_word(fresh, magic);
    write_word(fresh, numbers);
    if (!fresh.flush()) fail("cannot be written");
  }
  file_.open(path_, std::ios::in | std::ios::out | std::ios::binary);
  if (!file_ || read_word(file_) != magic || read_word(file_) != numbers) {
    fail("holds no states of this simulation; begin again with --overwrite");
  }
  const std::uint64_t records = (std::filesystem::file_size(path_) - header_bytes) / record_bytes();
  for (std::uint64_t i = 0; i < records; ++i) {
    file_.seekg(static_cast<std::streamoff>(header_bytes + i * record_bytes()));
    const std::uint64_t frame = read_word(file_);
    if (!file_) fail("cannot be read");
    if (frame >= frames || (!frames_.empty() && frame <= frames_.back())) break;
    frames_.push_back(frame);
  }
}

void StateFile::append(std::uint64_t frame, std::span<const double> state) {
  if (state.size() != numbers_) throw std::invalid_argument("a state of another count of numbers");
  file_.seekp(static_cast<std::streamoff>(header_bytes + frames_.size() * record_bytes()));
  write_word(file_, frame);
  file_.write(reinterpret_cast<const char*>(state.data()), static_cast<std::streamsize>(state.size_bytes()));
  if (!file_.flush()) fail("cannot be written");
  frames_.push_back(frame);
}

std::vector<double> StateFile::read(std::size_t index) {
  std::vector<double> state(numbers_);
  file_.seekg(static_cast<std::streamoff>(header_bytes + index * record_bytes() + sizeof(std::uint64_t)));
  file_.read(reinterpret_cast<char*>(state.data()), static_cast<std::streamsize>(numbers_ * sizeof(double)));
  if (!file_) fail("cannot be read");
  return state;
}

}  // namespace greenloop::offline
