// Drives a fuzz target without libFuzzer: every file of the given folders, then changed copies of them. Seeded: the same runs every time.
//
//   fuzz_urdf --runs 1000 --seed 1 FOLDER_OR_FILE...
//
// Exit status 0 when every input was borne. An input that ends the program, or takes longer than 2 s, is kept as ./crash-TARGET, or where --crash says.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/input.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

constexpr std::size_t longest = 65536;  // bytes of a changed input

const Bytes* running = nullptr;
std::string crash_file;

// Only what a signal's handler may do.
void keep_and_die(int signal) {
  const int fd = open(crash_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (fd >= 0 && running != nullptr && write(fd, running->data(), running->size()) >= 0) close(fd);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// An input that takes longer hangs.
constexpr unsigned longest_s = 2;

void run(const Bytes& input) {
  running = &input;
  alarm(longest_s);
  const Bytes exact(input);  // no byte to spare behind it
  (void)LLVMFuzzerTestOneInput(exact.data(), exact.size());
  alarm(0);
}

void read_into(std::vector<Bytes>& corpus, const fs::path& path) {
  std::vector<fs::path> files;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  } else {
    files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
}

// Changes an input as libFuzzer's simplest mutations do.
class Changer {
 public:
  Changer(const std::vector<Bytes>& corpus, std::uint64_t seed) : corpus_(corpus), random_(seed) {}

  Bytes next() {
    Bytes bytes = corpus_[below(corpus_.size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(bytes);
    bytes.resize(std::min(bytes.size(), longest));
    return bytes;
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  static Bytes::iterator at(Bytes& bytes, std::size_t place) { return bytes.begin() + static_cast<std::ptrdiff_t>(place); }

  void change(Bytes& bytes) {
    const std::size_t place = below(bytes.size() + 1);
    switch (bytes.empty() ? 3 : below(7)) {
      case 0: bytes[below(bytes.size())] ^= static_cast<std::uint8_t>(1U << below(8)); return;
      case 1: bytes[below(bytes.size())] = byte(); return;
      case 2: put_number(bytes, below(bytes.size())); return;
      case 3: bytes.insert(at(bytes, place), 1 + below(8), byte()); return;
      case 4: bytes.erase(at(bytes, place), at(bytes, place + below(bytes.size() - place + 1))); return;
      case 5: splice(bytes, place, bytes); return;
      default: splice(bytes, place, corpus_[below(corpus_.size())]); return;
    }
  }
  // A number at the end of some range.
  void put_number(Bytes& bytes, std::size_t place) {
    constexpr std::array<std::uint64_t, 10> ends{0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0x7FFF'FFFF, 0x8000'0000, ~std::uint64_t{0}};
    const std::uint64_t number = ends[below(ends.size())] + random_() % 3 - 1;
    const std::size_t size = std::min(std::size_t{1} << below(4), bytes.size() - place);
    for (std::size_t i = 0; i < size; ++i) bytes[place + i] = static_cast<std::uint8_t>(number >> (8 * i));
  }
  // A piece of another input, or of this one.
  void splice(Bytes& bytes, std::size_t place, const Bytes& other) {
    const std::size_t from = below(other.size()), size = below(std::min<std::size_t>(other.size() - from, 256) + 1);
    const Bytes piece(other.begin() + static_cast<std::ptrdiff_t>(from), other.begin() + static_cast<std::ptrdiff_t>(from + size));
    bytes.insert(at(bytes, place), piece.begin(), piece.end());
  }

  const std::vector<Bytes>& corpus_;
  std::mt19937_64 random_;
};

}  // namespace

int main(int count, char** words) {
  std::uint64_t runs = 0, seed = 1;
  std::vector<Bytes> corpus;
  crash_file = "crash-" + fs::path(words[0]).filename().string();
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool valued = word.starts_with("--") && i + 1 < count;
    if (valued && word == "--runs")
      runs = std::strtoull(words[++i], nullptr, 10);
    else if (valued && word == "--seed")
      seed = std::strtoull(words[++i], nullptr, 10);
    else if (valued && word == "--crash")
      crash_file = words[++i];
    else
      read_into(corpus, word);
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) std::signal(signal, keep_and_die);
  for (const Bytes& input : corpus) run(input);
  std::printf("%zu inputs kept, %llu changed with seed %llu\n", corpus.size(), static_cast<unsigned long long>(runs),
              static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  if (corpus.empty()) corpus.emplace_back();
  Changer changer(corpus, seed);
  for (std::uint64_t i = 0; i < runs; ++i) run(changer.next());
  return 0;
}
