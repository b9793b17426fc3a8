// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/clock_page.hpp"

#include "common/unique_fd.hpp"
#include "timebox/clock_code.hpp"
#include "timebox/tracee.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <elf.h>
#include <new>
#include <span>
#include <string_view>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <vector>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kJump = 16; ///< octets of a function that are replaced

/// The functions of the vDSO that are replaced, by where they are in it. Empty: it is not as it was thought to be.
struct Replaced {
    std::uint64_t offset{0};
    char const* by{nullptr};
};

std::vector<Replaced> find_replaced() {
    auto const base = ::getauxval(AT_SYSINFO_EHDR); // of this kernel, as that of every program
    if (base == 0) {
        return {};
    }
    auto const* const image = reinterpret_cast<char const*>(base);
    auto const* const header = reinterpret_cast<Elf64_Ehdr const*>(image);
    std::span const sections{reinterpret_cast<Elf64_Shdr const*>(image + header->e_shoff), header->e_shnum};
    auto const table = std::ranges::find(sections, Elf64_Word{SHT_DYNSYM}, &Elf64_Shdr::sh_type);
    if (table == sections.end() || table->sh_link >= sections.size()) {
        return {};
    }
    char const* const names = image + sections[table->sh_link].sh_offset;
    std::span const symbols{reinterpret_cast<Elf64_Sym const*>(image + table->sh_offset),
                            table->sh_size / sizeof(Elf64_Sym)};
    std::vector<Replaced> out;
    std::vector<std::uint64_t> starts;
    for (Elf64_Sym const& symbol : symbols) {
        if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC) {
            continue;
        }
        starts.push_back(symbol.st_value);
        std::string_view const name = names + symbol.st_name;
        char const* const by = name == "__vdso_clock_gettime"  ? gridspace_clock_gettime
                               : name == "__vdso_gettimeofday" ? gridspace_gettimeofday
                               : name == "__vdso_time"         ? gridspace_time
                               : name == "__vdso_getrandom"    ? gridspace_getrandom
                                                               : nullptr;
        if (by != nullptr) {
            out.push_back({symbol.st_value, by});
        }
    }
    for (Replaced const& each : out) { // nothing else is where the jumps will be
        for (std::uint64_t const start : starts) {
            if (start > each.offset && start < each.offset + kJump) {
                return {};
            }
        }
    }
    return out.size() >= 3 ? out : std::vector<Replaced>{};
}

/// Text pages are the program's alone as soon as they are written to.
bool poke(pid_t tid, std::uint64_t address, std::span<std::uint8_t const> octets) {
    for (std::size_t at = 0; at < octets.size(); at += sizeof(long)) {
        long word = 0;
        std::memcpy(&word, octets.data() + at, std::min(sizeof word, octets.size() - at));
        if (::ptrace(PTRACE_POKEDATA, tid, address + at, word) != 0) {
            return false;
        }
    }
    return true;
}

/// Code that maps two pages of a file without a name, and stops: %rbx is its descriptor, %rax where it is. Then it
/// closes the descriptor, and stops.
constexpr std::array<std::uint8_t, 112> kMap{
    0x68, 0x63, 0x6C, 0x6B, 0x00,             // push "clk"
    0x48, 0x89, 0xE7,                         // mov %rsp, %rdi
    0xBE, 0x01, 0x00, 0x00, 0x00,             // mov $MFD_CLOEXEC, %esi
    0xB8, 0x3F, 0x01, 0x00, 0x00,             // mov $memfd_create, %eax
    0x0F, 0x05,                               // syscall
    0x89, 0xC3,                               // mov %eax, %ebx
    0x89, 0xDF,                               // mov %ebx, %edi
    0xBE, 0x00, 0x20, 0x00, 0x00,             // mov $8192, %esi
    0xB8, 0x4D, 0x00, 0x00, 0x00,             // mov $ftruncate, %eax
    0x0F, 0x05,                               // syscall
    0x31, 0xFF,                               // xor %edi, %edi
    0xBE, 0x00, 0x20, 0x00, 0x00,             // mov $8192, %esi
    0xBA, 0x03, 0x00, 0x00, 0x00,             // mov $PROT_READ|PROT_WRITE, %edx
    0x41, 0xBA, 0x01, 0x00, 0x00, 0x00,       // mov $MAP_SHARED, %r10d
    0x41, 0x89, 0xD8,                         // mov %ebx, %r8d
    0x45, 0x31, 0xC9,                         // xor %r9d, %r9d
    0xB8, 0x09, 0x00, 0x00, 0x00,             // mov $mmap, %eax
    0x0F, 0x05,                               // syscall
    0x49, 0x89, 0xC4,                         // mov %rax, %r12
    0x48, 0x8D, 0xB8, 0x00, 0x10, 0x00, 0x00, // lea 4096(%rax), %rdi
    0xBE, 0x00, 0x10, 0x00, 0x00,             // mov $4096, %esi
    0xBA, 0x05, 0x00, 0x00, 0x00,             // mov $PROT_READ|PROT_EXEC, %edx
    0xB8, 0x0A, 0x00, 0x00, 0x00,             // mov $mprotect, %eax
    0x0F, 0x05,                               // syscall
    0xCC,                                     // int3
    0x89, 0xDF,                               // mov %ebx, %edi
    0xB8, 0x03, 0x00, 0x00, 0x00,             // mov $close, %eax
    0x0F, 0x05,                               // syscall
    0xCC,                                     // int3
};

/// Lets it run to the next int3. False: it has ended.
bool run_to_stop(pid_t tid) {
    std::vector<int> signals;
    bool stopped = false;
    while (!stopped) {
        ::ptrace(PTRACE_CONT, tid, nullptr, nullptr);
        int status = 0;
        while (::waitpid(tid, &status, __WALL) < 0 && errno == EINTR) {
        }
        if (!WIFSTOPPED(status)) {
            return false;
        }
        if (status >> 16 != 0) {
            continue; // calls of ours, which the filter stops too
        }
        stopped = WSTOPSIG(status) == SIGTRAP;
        if (!stopped) {
            signals.push_back(WSTOPSIG(status));
        }
    }
    for (int const signal : signals) { // for the program, when it begins
        ::syscall(SYS_tkill, tid, signal);
    }
    return true;
}

std::shared_ptr<ClockPage> map_page(pid_t tid, int fd) {
    UniqueFd const process{static_cast<int>(::syscall(SYS_pidfd_open, tid, 0))};
    UniqueFd const file{static_cast<int>(::syscall(SYS_pidfd_getfd, process.get(), fd, 0))};
    void* const at = file ? ::mmap(nullptr, 2 * kPage, PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0) : MAP_FAILED;
    if (at == MAP_FAILED) {
        return nullptr;
    }
    std::memcpy(static_cast<char*>(at) + kPage, gridspace_clock_begin,
                static_cast<std::size_t>(gridspace_clock_end - gridspace_clock_begin));
    return {new (at) ClockPage, [](ClockPage* page) { ::munmap(page, 2 * kPage); }};
}

} // namespace

bool ClockPages::install(pid_t tid, std::uint64_t vdso) {
    static std::vector<Replaced> const replaced = find_replaced();
    pages_.erase(tid);
    if (replaced.empty() || vdso == 0) {
        return false;
    }
    before_it_goes_on(tid);
    user_regs_struct registers{};
    ::ptrace(PTRACE_GETREGS, tid, nullptr, &registers);
    std::uint64_t const at = vdso + replaced.front().offset;
    std::array<std::uint8_t, kMap.size()> original{};
    if (!read_memory(tid, at, original.data(), original.size())) {
        return false;
    }
    if (!poke(tid, at, kMap)) {
        (void)poke(tid, at, original);
        return false;
    }
    user_regs_struct ours = registers;
    ours.rip = at;
    ours.orig_rax = static_cast<unsigned long long>(-1LL);
    ::ptrace(PTRACE_SETREGS, tid, nullptr, &ours);
    std::shared_ptr<ClockPage> page;
    bool alive = run_to_stop(tid);
    if (alive) {
        ::ptrace(PTRACE_GETREGS, tid, nullptr, &ours);
        page = map_page(tid, static_cast<int>(ours.rbx));
        alive = run_to_stop(tid);
    }
    std::uint64_t const code = ours.r12 + kPage;
    registers.rax = 0; // as at the end of an exec
    registers.orig_rax = static_cast<unsigned long long>(-1LL);
    ::ptrace(PTRACE_SETREGS, tid, nullptr, &registers);
    bool placed = poke(tid, at, original) && page != nullptr;
    for (Replaced const& each : replaced) {
        std::array<std::uint8_t, kJump> jump{0x48, 0xB8, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xE0, 0xCC, 0xCC, 0xCC, 0xCC};
        std::uint64_t const to = code + static_cast<std::uint64_t>(each.by - gridspace_clock_begin);
        std::memcpy(jump.data() + 2, &to, sizeof to); // movabs, jmp *%rax
        placed = placed && poke(tid, vdso + each.offset, jump);
    }
    if (alive && placed) {
        pages_[tid] = std::move(page);
    }
    return alive && placed;
}

void ClockPages::forked(pid_t parent, pid_t child) {
    if (auto const found = pages_.find(parent); found != pages_.end()) {
        pages_[child] = found->second;
    }
}

ClockPage* ClockPages::begin(pid_t process) {
    auto const found = pages_.find(process);
    running_ = found == pages_.end() ? nullptr : found->second;
    return running_.get();
}

} // namespace gridspace::timebox
