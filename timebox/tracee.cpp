// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/tracee.hpp"

#include <algorithm>
#include <elf.h>
#include <iterator>
#include <linux/seccomp.h>
#include <map>
#include <optional>
#include <sys/ioctl.h>
#include <sys/ptrace.h>
#include <sys/uio.h>
#include <sys/user.h>

namespace gridspace::timebox {
namespace {

/// Of the thread that was looked at last: what is changed here is written back once, before it goes on.
struct Kept {
    pid_t tid{0}; ///< 0: none
    bool changed{false};
    user_regs_struct registers{};
};
thread_local Kept kept;

void write_back() {
    if (kept.tid != 0 && kept.changed) {
        ::ptrace(PTRACE_SETREGS, kept.tid, nullptr, &kept.registers);
    }
    kept.tid = 0;
    kept.changed = false;
}

user_regs_struct registers_of(pid_t tid) {
    if (kept.tid != tid) {
        write_back();
        kept.registers = {};
        kept.tid = ::ptrace(PTRACE_GETREGS, tid, nullptr, &kept.registers) == 0 ? tid : 0;
    }
    return kept.registers;
}

void set(pid_t tid, user_regs_struct const& registers) {
    if (kept.tid != tid) {
        write_back();
        kept.tid = tid;
    }
    kept.registers = registers;
    kept.changed = true;
}

void set_arguments(user_regs_struct& r, Call const& call) {
    r.rdi = call.arguments[0];
    r.rsi = call.arguments[1];
    r.rdx = call.arguments[2];
    r.r10 = call.arguments[3];
    r.r8 = call.arguments[4];
    r.r9 = call.arguments[5];
}

constexpr std::uint64_t kCallInstruction = 2; // octets of SYSCALL

/// A call that came as a notification, and its answer; without one it runs as it is.
struct Notified {
    int listener{-1};
    std::uint64_t id{0};
    Call call;
    std::optional<std::int64_t> result;
};
thread_local std::map<pid_t, Notified> notified_calls;

Notified* notified(pid_t tid) {
    auto const it = notified_calls.find(tid);
    return it == notified_calls.end() ? nullptr : &it->second;
}

} // namespace

void before_it_goes_on(pid_t tid) {
    if (kept.tid == tid) {
        write_back();
    }
}

pid_t take_notification(int listener) {
    seccomp_notif told{};
    if (::ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &told) != 0) {
        return 0;
    }
    auto const tid = static_cast<pid_t>(told.pid);
    Notified& n = notified_calls[tid];
    n = {.listener = listener, .id = told.id, .call = {.number = told.data.nr}, .result = {}};
    std::copy(std::begin(told.data.args), std::end(told.data.args), n.call.arguments.begin());
    return tid;
}

bool is_notified(pid_t tid) {
    return notified(tid) != nullptr;
}

bool waits_for_answer(pid_t tid) {
    Notified const* const n = notified(tid);
    return n != nullptr && ::ioctl(n->listener, SECCOMP_IOCTL_NOTIF_ID_VALID, &n->id) == 0;
}

void forget_tracee(pid_t tid) {
    notified_calls.erase(tid);
    if (kept.tid == tid) {
        kept = {};
    }
}

void let_run(pid_t tid, GoOn how, int signal) {
    if (Notified const* const n = notified(tid)) {
        seccomp_notif_resp answer{};
        answer.id = n->id;
        if (!n->result) {
            answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
        } else if (*n->result < 0) {
            answer.error = static_cast<std::int32_t>(*n->result);
        } else {
            answer.val = *n->result;
        }
        int const listener = n->listener;
        notified_calls.erase(tid);
        (void)::ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer); // a killed thread is seen by waitpid
        return;
    }
    before_it_goes_on(tid);
    ::ptrace(how == GoOn::to_exit ? PTRACE_SYSCALL : PTRACE_CONT, tid, nullptr, signal);
}

Call call_of(pid_t tid) {
    if (Notified const* const n = notified(tid)) {
        return n->call;
    }
    user_regs_struct const r = registers_of(tid);
    return {static_cast<long>(r.orig_rax), {r.rdi, r.rsi, r.rdx, r.r10, r.r8, r.r9}};
}

void answer(pid_t tid, std::int64_t result) {
    if (Notified* const n = notified(tid)) {
        n->result = result;
        return;
    }
    user_regs_struct r = registers_of(tid);
    r.orig_rax = static_cast<unsigned long long>(-1LL); // seccomp(2): a number of -1 is no call
    r.rax = static_cast<unsigned long long>(result);
    set(tid, r);
}

void replace(pid_t tid, Call const& by) {
    user_regs_struct r = registers_of(tid);
    r.orig_rax = static_cast<unsigned long long>(by.number);
    set_arguments(r, by);
    set(tid, r);
}

void restore(pid_t tid, Call const& original) {
    user_regs_struct r = registers_of(tid);
    set_arguments(r, original);
    set(tid, r);
}

std::int64_t result_of(pid_t tid) {
    return static_cast<std::int64_t>(registers_of(tid).rax);
}

void make_again(pid_t tid, Call const& call) {
    user_regs_struct r = registers_of(tid);
    set_arguments(r, call);
    r.rip -= kCallInstruction;
    r.rax = static_cast<unsigned long long>(call.number);
    r.orig_rax = static_cast<unsigned long long>(-1LL); // the kernel restarts nothing by itself
    set(tid, r);
}

bool read_memory(pid_t tid, std::uint64_t address, void* to, std::size_t octets) {
    iovec const local{to, octets}, remote{reinterpret_cast<void*>(address), octets};
    return ::process_vm_readv(tid, &local, 1, &remote, 1, 0) == static_cast<ssize_t>(octets);
}

bool write_memory(pid_t tid, std::uint64_t address, void const* from, std::size_t octets) {
    iovec const local{const_cast<void*>(from), octets}, remote{reinterpret_cast<void*>(address), octets};
    return ::process_vm_writev(tid, &local, 1, &remote, 1, 0) == static_cast<ssize_t>(octets);
}

std::uint64_t stack_of(pid_t tid) {
    return registers_of(tid).rsp;
}

namespace {

/// The auxiliary vector of a new image, entry by entry, with where each is.
template <class Visit>
void visit_auxiliary(pid_t tid, Visit&& visit) {
    // Its stack: argc, argv, 0, environment, 0, auxiliary vector (System V ABI, x86-64, 3.4.1).
    std::uint64_t at = registers_of(tid).rsp;
    at += 8 * (value_at<std::uint64_t>(tid, at) + 2);
    while (value_at<std::uint64_t>(tid, at) != 0) {
        at += 8;
    }
    at += 8;
    for (auto entry = value_at<Elf64_auxv_t>(tid, at); entry.a_type != AT_NULL;
         at += sizeof entry, entry = value_at<Elf64_auxv_t>(tid, at)) {
        visit(entry, at);
    }
}

} // namespace

std::uint64_t prepare_image(pid_t tid, std::array<std::uint8_t, 16> const& random) {
    std::uint64_t vdso = 0;
    visit_auxiliary(tid, [&](Elf64_auxv_t const& entry, std::uint64_t) {
        if (entry.a_type == AT_SYSINFO_EHDR) {
            vdso = entry.a_un.a_val;
        } else if (entry.a_type == AT_RANDOM) {
            put(tid, entry.a_un.a_val, random);
        }
    });
    return vdso;
}

void take_vdso(pid_t tid) {
    visit_auxiliary(tid, [&](Elf64_auxv_t const& entry, std::uint64_t at) {
        if (entry.a_type == AT_SYSINFO_EHDR) {
            put(tid, at, std::uint64_t{AT_IGNORE});
        }
    });
}

bool answer_tick_counter(pid_t tid, std::uint64_t ticks) {
    user_regs_struct r = registers_of(tid);
    std::array<std::uint8_t, 3> code{};
    (void)read_memory(tid, r.rip, code.data(), code.size());
    bool const plain = code[0] == 0x0F && code[1] == 0x31;
    bool const with_id = code[0] == 0x0F && code[1] == 0x01 && code[2] == 0xF9;
    if (!plain && !with_id) {
        return false;
    }
    r.rip += plain ? 2 : 3;
    r.rax = ticks & 0xFFFFFFFFU;
    r.rdx = ticks >> 32U;
    r.rcx = with_id ? 0 : r.rcx;
    set(tid, r);
    return true;
}

} // namespace gridspace::timebox
