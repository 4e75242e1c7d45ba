// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as an (unpacked) MRPT rawlog. MRPT allocates what a length in the file says; modslam-import limits its memory, so that a wild
/// one ends in bad_alloc. AddressSanitizer would abort there: the operators below throw as the limited program's do.
#include <cstdlib>
#include <new>
#include <stdexcept>

#include "procs/import/import.hpp"

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 28;

void* allocate(std::size_t size, std::size_t alignment) {
  void* place = nullptr;
  if (size > kMostBytes || posix_memalign(&place, alignment, size) != 0) throw std::bad_alloc();
  return place;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new[](std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) { return allocate(size, static_cast<std::size_t>(alignment)); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return allocate(size, static_cast<std::size_t>(alignment)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return std::malloc(size); }  // the fuzzer's own
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return std::malloc(size); }
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    modslam::read_rawlog(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const std::runtime_error&) {
  }
  return 0;
}
