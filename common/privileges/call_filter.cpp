// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/privileges/call_filter.hpp"

#include "common/privileges/allowed_calls.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace gridspace {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
#else
constexpr bool kSanitized = false;
#endif

struct CallName {
    long number;
    char const* name;
};
/// Every call of the C library's headers, made of them when the build is configured.
constexpr CallName kCallNames[] = {
#include "common/privileges/call_names.inc"
};
/// Newer ones are not there for this build.
constexpr long kLastKnown = std::ranges::max_element(kCallNames, {}, &CallName::number)->number;

char const* name_of(long number) {
    if (number == SYS_socket) {
        return "socket (raw)";
    }
    if (number == SYS_clone) {
        return "clone (into a new namespace)";
    }
    auto const* const found = std::ranges::find(kCallNames, number, &CallName::number);
    return found == std::end(kCallNames) ? "a call of another processor" : found->name;
}

void write_text(char const* text) {
    [[maybe_unused]] auto const written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// On the thread that made the call; the next SIGSYS, its own, ends the process.
void on_forbidden_call(int /*signal*/, siginfo_t* info, void* /*context*/) {
    write_text("forbidden: this process called ");
    write_text(name_of(info->si_syscall));
    std::array<char, 40> number{" (system call "};
    auto* const end = std::to_chars(number.data() + 14, number.data() + 36, info->si_syscall).ptr;
    std::memcpy(end, ")", 2);
    write_text(number.data());
    write_text(", which no part of it has a reason to; it ends here\n");
    ::raise(SIGSYS);
}

#if defined(__x86_64__)
constexpr std::uint32_t kProcessor = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kProcessor = AUDIT_ARCH_AARCH64;
#else
#error "its number in <linux/audit.h> belongs here"
#endif

constexpr std::uint32_t kNewNamespaces =
    CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;

constexpr sock_filter load(std::size_t offset) {
    return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}
/// The next so many statements only if the loaded word is `value`.
constexpr sock_filter only_if_or_skip(long value, std::uint8_t statements) {
    return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(value), 0, statements);
}
constexpr sock_filter answer(std::uint32_t what) {
    return BPF_STMT(BPF_RET | BPF_K, what);
}

/// A filter of system calls, in the order in which its statements are put down.
class Filter {
  public:
    /// Calls of another processor's numbering (32 bits on x86) are none of ours.
    Filter()
        : statements_{load(offsetof(seccomp_data, arch)), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kProcessor, 1, 0),
                      answer(SECCOMP_RET_TRAP), load(offsetof(seccomp_data, nr))} {}

    void add(sock_filter statement) { statements_.push_back(statement); }
    void answer_to(long value, std::uint32_t what) {
        add(only_if_or_skip(value, 1));
        add(answer(what));
    }
    /// For all threads of the process. False where the kernel takes no filter.
    [[nodiscard]] bool install() const {
        struct sigaction action{};
        action.sa_sigaction = on_forbidden_call;
        action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND | SA_NODEFER);
        ::sigaction(SIGSYS, &action, nullptr);
        sock_fprog const program{static_cast<unsigned short>(statements_.size()),
                                 const_cast<sock_filter*>(statements_.data())};
        return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
               ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
    }

  private:
    std::vector<sock_filter> statements_;
};

} // namespace

bool allow_only_known_calls() noexcept {
    Filter filter;
    for (long const number : kAllowedCalls) {
        filter.answer_to(number, SECCOMP_RET_ALLOW);
    }
    if constexpr (kSanitized) {
        for (long const number : kAllowedUnderSanitizers) {
            filter.answer_to(number, SECCOMP_RET_ALLOW);
        }
    }
    // Its flags are in memory, where no filter sees them: it is not there, and the C library takes clone.
    filter.answer_to(SYS_clone3, SECCOMP_RET_ERRNO | ENOSYS);
    filter.add(only_if_or_skip(SYS_clone, 4));
    filter.add(load(offsetof(seccomp_data, args[0])));
    filter.add(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kNewNamespaces, 0, 1));
    filter.add(answer(SECCOMP_RET_TRAP));
    filter.add(answer(SECCOMP_RET_ALLOW));
    filter.add(BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, static_cast<std::uint32_t>(kLastKnown), 0, 1));
    filter.add(answer(SECCOMP_RET_ERRNO | ENOSYS));
    filter.add(answer(SECCOMP_RET_TRAP));
    return filter.install();
}

bool forbid_raw_sockets() noexcept {
    Filter filter;
    filter.answer_to(SYS_setns, SECCOMP_RET_TRAP);
    filter.add(only_if_or_skip(SYS_socket, 8));
    filter.add(load(offsetof(seccomp_data, args[0]))); // the low half, on machines of this order of octets
    filter.answer_to(AF_PACKET, SECCOMP_RET_TRAP);
    filter.add(only_if_or_skip(AF_INET, 4)); // netlink's sockets are raw too, and everybody has some
    filter.add(load(offsetof(seccomp_data, args[1])));
    filter.add(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xF)); // without SOCK_CLOEXEC and SOCK_NONBLOCK
    filter.answer_to(SOCK_RAW, SECCOMP_RET_TRAP);
    filter.add(answer(SECCOMP_RET_ALLOW));
    return filter.install();
}

} // namespace gridspace
