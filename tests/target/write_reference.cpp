// Writes down what the core computes on this machine, for another processor to be held to: write_reference FILE
#include <bit>
#include <cstdio>
#include <fstream>

#include "tests/target/ledger.hpp"
#include "tests/target/reference_file.hpp"

namespace lf::test {
namespace {

static_assert(std::endian::native == std::endian::little);

class Writer final : public Ledger {
 public:
  explicit Writer(const char* path) : file_(path, std::ios::binary) {}
  void operation(const char* name, double) override { integer(hash_of(name)); }
  void number(double value) override { integer(std::bit_cast<std::uint64_t>(value)); }
  void integer(std::uint64_t value) override {
    file_.write(reinterpret_cast<const char*>(&value), sizeof value);
    ++values_;
  }
  bool close() {
    file_.close();
    return file_.good() && values_ > 0;
  }

 private:
  void start() override {}
  void stop() override {}

  std::ofstream file_;
  std::uint64_t values_ = 0;
};

}  // namespace
}  // namespace lf::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FILE\n", argv[0]);
    return 2;
  }
  lf::test::Writer writer(argv[1]);
  lf::test::put_everything(writer);
  if (writer.close()) return 0;
  std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
  return 2;
}
