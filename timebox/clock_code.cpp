// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// x86-64. In %r8 the ClockPage, which is one page before this code; numbers are the offsets of its members, and of
// the system calls that are made where it cannot answer. Registers that are used belong to the caller of any function.
#include "timebox/clock_code.hpp"

#include "timebox/clock_page.hpp"
#include "timebox/simulated_clock.hpp"

static_assert(gridspace::timebox::SimulatedClock::kReadNs == 100);
static_assert(offsetof(gridspace::timebox::ClockPage, last_ns) == 8);
static_assert(offsetof(gridspace::timebox::ClockPage, looks_left) == 16);
static_assert(offsetof(gridspace::timebox::ClockPage, looks) == 24);
static_assert(offsetof(gridspace::timebox::ClockPage, offsets_ns) == 48);

asm(R"(
    .pushsection .rodata
    .balign 16
    .globl gridspace_clock_begin, gridspace_clock_gettime, gridspace_gettimeofday
    .globl gridspace_time, gridspace_getrandom, gridspace_clock_end

    /* in %rax the time before the look; the look is counted at \count; where it may not be answered, to \call */
    .macro gridspace_look count, call
    lea .Lgridspace_begin-4096(%rip), %r8
    mov (%r8), %rax
    lea 100(%rax), %rcx
    cmp 8(%r8), %rcx
    jg \call
    cmpq $0, 16(%r8)
    jle \call
    decq 16(%r8)
    incq \count(%r8)
    mov %rcx, (%r8)
    .endm

gridspace_clock_begin:
.Lgridspace_begin:
gridspace_clock_gettime:             /* (%edi clock, %rsi timespec) */
    cmp $11, %edi
    ja 1f
    gridspace_look 24, 1f
    mov %edi, %edi
    add 48(%r8,%rdi,8), %rax
    xor %edx, %edx
    mov $1000000000, %ecx
    div %rcx
    mov %rax, (%rsi)
    mov %rdx, 8(%rsi)
    xor %eax, %eax
    ret
1:  mov $228, %eax
    syscall
    ret

    .balign 16
gridspace_gettimeofday:              /* (%rdi timeval, %rsi zone, which nobody has) */
    test %rdi, %rdi
    jz 1f
    gridspace_look 32, 1f
    add 48(%r8), %rax
    xor %edx, %edx
    mov $1000000000, %ecx
    div %rcx
    mov %rax, (%rdi)
    mov %rdx, %rax
    xor %edx, %edx
    mov $1000, %ecx
    div %rcx
    mov %rax, 8(%rdi)
    xor %eax, %eax
    ret
1:  mov $96, %eax
    syscall
    ret

    .balign 16
gridspace_time:                      /* (%rdi time_t or 0) */
    gridspace_look 40, 1f
    add 48(%r8), %rax
    xor %edx, %edx
    mov $1000000000, %ecx
    div %rcx
    test %rdi, %rdi
    jz 2f
    mov %rax, (%rdi)
2:  ret
1:  mov $201, %eax
    syscall
    ret

    .balign 16
gridspace_getrandom:                 /* nobody may draw in user space: they make the call */
    mov $-38, %rax
    ret
gridspace_clock_end:
    .popsection
)");
