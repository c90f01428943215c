// Computes on this processor what was written down on x86-64 and compares, counting the instructions of each operation.
// Arguments: the file of tests/target/write_reference.cpp. Exit status 1 when anything differs by more than its tolerance.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "tests/target/ledger.hpp"
#include "tests/target/reference_file.hpp"
#include "tests/target/same_everywhere.hpp"
#include "toolchain/cortex_m7/instruction_counter.hpp"
#include "toolchain/cortex_m7/semihosting.hpp"
#include "toolchain/cortex_m7/stack_use.hpp"

namespace lf::test {
namespace {

using m7::print, m7::print_number, m7::print_small;

class Comparison final : public Ledger {
 public:
  explicit Comparison(m7::HostFile& file) : file_(file) {}

  void operation(const char* name, double tolerance) override {
    report();
    if (word() != hash_of(name)) {
      print("the reference is another program's: it has no ");
      m7::fail(name);
    }
    row_ = {.name = name, .tolerance = tolerance};
  }
  void number(double value) override {
    const double there = std::bit_cast<double>(word());
    ++row_.values;
    if (std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(there)) ++row_.same_bits;
    const double difference = std::abs(value - there);
    row_.worst = std::max(row_.worst, std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference);
  }
  void integer(std::uint64_t value) override {
    ++row_.values;
    if (word() == value)
      ++row_.same_bits;
    else
      row_.worst = std::numeric_limits<double>::infinity();
  }
  // After the last operation; how many were out of tolerance.
  int finish() {
    report();
    std::uint8_t byte;
    if (file_.read(&byte, 1)) m7::fail("the reference goes on: this program is older than the one that wrote it");
    return failed_;
  }

 private:
  struct Row {
    const char* name = nullptr;
    double tolerance = 0;
    std::uint32_t values = 0, same_bits = 0, turns = 0;
    double worst = 0;
    std::uint64_t instructions = 0, most = 0;
  };

  void start() override { counter_.start(); }
  void stop() override {
    const std::uint64_t n = counter_.stop();
    ++row_.turns;
    row_.instructions += n;
    row_.most = std::max(row_.most, n);
  }

  std::uint64_t word() {
    std::uint64_t value;
    if (!file_.read(&value, sizeof value)) m7::fail("the reference ends too early: make it anew with write_reference");
    return value;
  }

  void report() {
    if (row_.name == nullptr) return;
    const bool good = row_.worst <= row_.tolerance;
    failed_ += good ? 0 : 1;
    print(good ? "  " : "X ");
    print(row_.name);
    for (int i = static_cast<int>(std::strlen(row_.name)); i < 36; ++i) print(" ");
    print_number(row_.turns > 0 ? static_cast<double>(row_.instructions / row_.turns) : 0, 0, 12);
    print_number(static_cast<double>(row_.most), 0, 12);
    print_number(row_.same_bits, 0, 9);
    print(" of ");
    print_number(row_.values, 0, 6);
    print("   ");
    std::isfinite(row_.worst) ? print_small(row_.worst) : print("an outcome or a count");
    print(" (");
    print_small(row_.tolerance);
    print(")\n");
  }

  m7::HostFile& file_;
  m7::InstructionCounter counter_;
  Row row_;
  int failed_ = 0;
};

void print_size(const char* what, std::size_t bytes) {
  print("sizeof(");
  print(what);
  print(") = ");
  print_number(static_cast<double>(bytes));
  print("\n");
}

int run() {
  char path[512];
  if (!m7::argument(1, path, sizeof path)) m7::fail("no reference named");
  static m7::HostFile file(path);
  if (!file.open()) m7::fail("the reference cannot be opened");

  print("Cortex-M7 against x86-64       instructions a turn:  mean        most    same bits          worst difference (tolerance)\n");
  Comparison comparison(file);
  put_everything(comparison);
  const int failed = comparison.finish();

  print_size("Controller", sizeof(Controller));
  print_size("TickOutput", sizeof(TickOutput));
  print_size("CoreRings", sizeof(hal::CoreRings));
  print_size("ScanPipeline, full", sizeof(BasicScanPipeline<full_scan>));
  print_size("ScanPipeline, compact", sizeof(BasicScanPipeline<compact_scan>));
  print_size("ScanPipeline, small", sizeof(BasicScanPipeline<small_scan>));
  print("stack used: ");
  print_number(static_cast<double>(m7::stack_used_bytes()));
  print(" of ");
  print_number(static_cast<double>(m7::stack_bytes()));
  print(" bytes\n");

  std::uint32_t fpscr;
  asm volatile("vmrs %0, fpscr" : "=r"(fpscr));
  constexpr std::uint32_t invalid_or_division_or_overflow = 7;
  if ((fpscr & invalid_or_division_or_overflow) != 0) {
    print("X floating-point exceptions: FPSCR ");
    m7::print_hex(fpscr);
    print("\n");
    return 1;
  }
  if (m7::stack_used_bytes() >= m7::stack_bytes()) m7::fail("the stack overflowed");
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace lf::test

int main() { return lf::test::run(); }
