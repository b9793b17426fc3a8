// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/privileges.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <linux/audit.h>
#include <linux/capability.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GRIDSPACE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define GRIDSPACE_SANITIZED 1
#endif
#endif

namespace gridspace {
namespace {

struct Call {
    long number;
    char const* name;
};

#define GRIDSPACE_CALL(name)                                                                                           \
    Call {                                                                                                             \
        SYS_##name, #name                                                                                              \
    }
constexpr std::array kNeverUsed{
#ifndef GRIDSPACE_SANITIZED // LeakSanitizer traces its own process, and reports run a symbolizer
    GRIDSPACE_CALL(execve),
    GRIDSPACE_CALL(execveat),
    GRIDSPACE_CALL(ptrace),
    GRIDSPACE_CALL(process_vm_readv),
#endif
    GRIDSPACE_CALL(process_vm_writev),
    GRIDSPACE_CALL(pidfd_getfd),
    GRIDSPACE_CALL(unshare),
    GRIDSPACE_CALL(mount),
    GRIDSPACE_CALL(umount2),
    GRIDSPACE_CALL(pivot_root),
    GRIDSPACE_CALL(chroot),
    GRIDSPACE_CALL(move_mount),
    GRIDSPACE_CALL(open_tree),
    GRIDSPACE_CALL(fsopen),
    GRIDSPACE_CALL(fsmount),
    GRIDSPACE_CALL(mknodat),
    GRIDSPACE_CALL(name_to_handle_at),
    GRIDSPACE_CALL(open_by_handle_at),
    GRIDSPACE_CALL(init_module),
    GRIDSPACE_CALL(finit_module),
    GRIDSPACE_CALL(delete_module),
    GRIDSPACE_CALL(kexec_load),
    GRIDSPACE_CALL(reboot),
    GRIDSPACE_CALL(swapon),
    GRIDSPACE_CALL(swapoff),
    GRIDSPACE_CALL(bpf),
    GRIDSPACE_CALL(perf_event_open),
    GRIDSPACE_CALL(userfaultfd),
    GRIDSPACE_CALL(io_uring_setup),
    GRIDSPACE_CALL(add_key),
    GRIDSPACE_CALL(request_key),
    GRIDSPACE_CALL(keyctl),
    GRIDSPACE_CALL(acct),
    GRIDSPACE_CALL(quotactl),
    GRIDSPACE_CALL(fanotify_init),
    GRIDSPACE_CALL(settimeofday),
    GRIDSPACE_CALL(clock_settime),
    GRIDSPACE_CALL(sethostname),
    GRIDSPACE_CALL(setdomainname),
    GRIDSPACE_CALL(setuid),
    GRIDSPACE_CALL(setgid),
    GRIDSPACE_CALL(setresuid),
    GRIDSPACE_CALL(setresgid),
    GRIDSPACE_CALL(setgroups),
};
constexpr Call kEnterNamespace = GRIDSPACE_CALL(setns);
constexpr Call kSocket = GRIDSPACE_CALL(socket);
constexpr Call kClone = GRIDSPACE_CALL(clone);
constexpr Call kClone3 = GRIDSPACE_CALL(clone3);
#undef GRIDSPACE_CALL

char const* name_of(long number) {
    for (Call const& call : kNeverUsed) {
        if (call.number == number) {
            return call.name;
        }
    }
    return number == kEnterNamespace.number ? kEnterNamespace.name
           : number == kSocket.number       ? "socket (raw)"
           : number == kClone.number        ? "clone (into a new namespace)"
                                            : "a call of another processor";
}

void write_text(char const* text) {
    [[maybe_unused]] auto const written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// On the thread that made the call; the next SIGSYS, its own, ends the process.
void on_forbidden_call(int /*signal*/, siginfo_t* info, void* /*context*/) {
    write_text("forbidden: this process called ");
    write_text(name_of(info->si_syscall));
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
constexpr sock_filter only_if_or_skip(std::uint32_t value, std::uint8_t statements) {
    return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, statements);
}
constexpr sock_filter answer(std::uint32_t what) {
    return BPF_STMT(BPF_RET | BPF_K, what);
}

bool install(std::vector<sock_filter> const& statements) {
    struct sigaction action{};
    action.sa_sigaction = on_forbidden_call;
    action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND | SA_NODEFER);
    ::sigaction(SIGSYS, &action, nullptr);
    sock_fprog const program{static_cast<unsigned short>(statements.size()),
                             const_cast<sock_filter*>(statements.data())};
    return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
}

/// Calls of another processor's numbering (32 bits on x86) are none of ours.
std::vector<sock_filter> filter_begin() {
    return {load(offsetof(seccomp_data, arch)), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kProcessor, 1, 0),
            answer(SECCOMP_RET_TRAP), load(offsetof(seccomp_data, nr))};
}

void forbid(std::vector<sock_filter>& statements, long number) {
    statements.push_back(only_if_or_skip(static_cast<std::uint32_t>(number), 1));
    statements.push_back(answer(SECCOMP_RET_TRAP));
}

} // namespace

void keep_only_capabilities(std::uint64_t capabilities) noexcept {
    for (unsigned bit = 0; ::prctl(PR_CAPBSET_READ, bit, 0, 0, 0) >= 0; ++bit) {
        if ((capabilities >> bit & 1U) == 0) {
            ::prctl(PR_CAPBSET_DROP, bit, 0, 0, 0);
        }
    }
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> sets{};
    if (::syscall(SYS_capget, &header, sets.data()) == 0) {
        for (std::size_t word = 0; word < sets.size(); ++word) {
            auto const kept = static_cast<std::uint32_t>(capabilities >> (32 * word));
            sets[word].permitted &= kept;
            sets[word].effective = sets[word].permitted;
            sets[word].inheritable = 0;
        }
        ::syscall(SYS_capset, &header, sets.data());
    }
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
}

bool forbid_what_no_process_does() noexcept {
    std::vector<sock_filter> statements = filter_begin();
    for (Call const& call : kNeverUsed) {
        forbid(statements, call.number);
    }
    // Its flags are in memory, where no filter sees them: it is not there, and the C library takes clone.
    statements.push_back(only_if_or_skip(static_cast<std::uint32_t>(kClone3.number), 1));
    statements.push_back(answer(SECCOMP_RET_ERRNO | ENOSYS));
    statements.push_back(only_if_or_skip(static_cast<std::uint32_t>(kClone.number), 3));
    statements.push_back(load(offsetof(seccomp_data, args[0])));
    statements.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kNewNamespaces, 0, 1));
    statements.push_back(answer(SECCOMP_RET_TRAP));
    statements.push_back(answer(SECCOMP_RET_ALLOW));
    return install(statements);
}

bool may_open_raw_sockets() noexcept {
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> sets{};
    return ::syscall(SYS_capget, &header, sets.data()) == 0 && (sets[0].effective & kMayOpenRawSockets) != 0;
}

bool forbid_raw_sockets() noexcept {
    std::vector<sock_filter> statements = filter_begin();
    forbid(statements, kEnterNamespace.number);
    statements.push_back(only_if_or_skip(static_cast<std::uint32_t>(kSocket.number), 8));
    statements.push_back(load(offsetof(seccomp_data, args[0]))); // the low half, on machines of this order of octets
    forbid(statements, AF_PACKET);
    statements.push_back(only_if_or_skip(AF_INET, 4)); // netlink's sockets are raw too, and everybody has some
    statements.push_back(load(offsetof(seccomp_data, args[1])));
    statements.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xF)); // without SOCK_CLOEXEC and SOCK_NONBLOCK
    forbid(statements, SOCK_RAW);
    statements.push_back(answer(SECCOMP_RET_ALLOW));
    return install(statements);
}

} // namespace gridspace
