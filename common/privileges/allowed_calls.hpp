// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/syscall.h>

namespace gridspace {

/// The system calls that the programs of a run may make, by what they are for. The groups are generous, as those of
/// systemd.exec(5) are (SystemCallFilter=@system-service): another C library, kernel or processor makes other calls of
/// a group for the same work. What is in no group: executing programs, tracing, mounting, namespaces, modules, keys,
/// other users, clocks, new interfaces of the kernel. On aarch64 the older calls do not exist.
// clang-format off
inline constexpr long kAllowedCalls[] = {
    // what happens most, first: an old kernel looks at them in this order
    SYS_futex, SYS_sendto, SYS_recvfrom, SYS_sendmsg, SYS_recvmsg, SYS_sendmmsg, SYS_recvmmsg, SYS_gettid, SYS_read, SYS_write,
    SYS_ppoll, SYS_epoll_pwait, SYS_clock_gettime, SYS_clock_nanosleep,
    // octets of files, pipes and devices
    SYS_readv, SYS_writev, SYS_pread64, SYS_pwrite64, SYS_preadv, SYS_pwritev, SYS_preadv2, SYS_pwritev2, SYS_lseek, SYS_close, SYS_close_range,
    SYS_dup, SYS_dup3, SYS_fcntl, SYS_ioctl, SYS_pipe2, SYS_splice, SYS_tee, SYS_vmsplice, SYS_sendfile, SYS_copy_file_range, SYS_fsync,
    SYS_fdatasync, SYS_sync_file_range, SYS_sync, SYS_syncfs, SYS_fallocate, SYS_fadvise64, SYS_readahead, SYS_flock, SYS_ftruncate, SYS_truncate,
    // files
    SYS_openat, SYS_openat2, SYS_fstat, SYS_newfstatat, SYS_statx, SYS_faccessat, SYS_faccessat2, SYS_readlinkat, SYS_getcwd, SYS_chdir,
    SYS_fchdir, SYS_getdents64, SYS_mkdirat, SYS_unlinkat, SYS_renameat, SYS_renameat2, SYS_linkat, SYS_symlinkat, SYS_fchmod, SYS_fchmodat,
    SYS_umask, SYS_utimensat, SYS_statfs, SYS_fstatfs, SYS_inotify_init1, SYS_inotify_add_watch, SYS_inotify_rm_watch, SYS_getxattr,
    SYS_lgetxattr, SYS_fgetxattr, SYS_listxattr, SYS_flistxattr,
    // waiting
    SYS_pselect6, SYS_epoll_create1, SYS_epoll_ctl, SYS_epoll_pwait2, SYS_eventfd2, SYS_signalfd4, SYS_timerfd_create, SYS_timerfd_settime,
    SYS_timerfd_gettime, SYS_timer_create, SYS_timer_settime, SYS_timer_gettime, SYS_timer_getoverrun, SYS_timer_delete, SYS_setitimer,
    SYS_getitimer, SYS_nanosleep,
    // clocks, read only
    SYS_clock_getres, SYS_gettimeofday, SYS_times,
    // network (raw sockets: forbid_raw_sockets)
    SYS_socket, SYS_socketpair, SYS_bind, SYS_listen, SYS_accept, SYS_accept4, SYS_connect, SYS_getsockname, SYS_getpeername, SYS_shutdown,
    SYS_setsockopt, SYS_getsockopt, SYS_setns,
    // memory
    SYS_brk, SYS_mmap, SYS_munmap, SYS_mprotect, SYS_mremap, SYS_madvise, SYS_mincore, SYS_msync, SYS_mlock, SYS_mlock2, SYS_mlockall,
    SYS_munlock, SYS_munlockall, SYS_memfd_create, SYS_mbind, SYS_get_mempolicy, SYS_set_mempolicy, SYS_pkey_alloc, SYS_pkey_free,
    SYS_pkey_mprotect, SYS_membarrier, SYS_shmget, SYS_shmat, SYS_shmctl, SYS_shmdt,
    // threads and their scheduling
    SYS_exit, SYS_exit_group, SYS_set_tid_address, SYS_set_robust_list, SYS_get_robust_list, SYS_rseq, SYS_sched_yield, SYS_sched_setscheduler,
    SYS_sched_getscheduler, SYS_sched_setparam, SYS_sched_getparam, SYS_sched_setattr, SYS_sched_getattr, SYS_sched_setaffinity,
    SYS_sched_getaffinity, SYS_sched_get_priority_max, SYS_sched_get_priority_min, SYS_sched_rr_get_interval, SYS_getpriority, SYS_setpriority,
    SYS_ioprio_get, SYS_ioprio_set, SYS_getcpu,
    // signals and other processes of this user
    SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigpending, SYS_rt_sigtimedwait, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo, SYS_rt_sigsuspend,
    SYS_rt_sigreturn, SYS_sigaltstack, SYS_restart_syscall, SYS_kill, SYS_tkill, SYS_tgkill, SYS_pidfd_open, SYS_pidfd_send_signal, SYS_wait4,
    SYS_waitid, SYS_setsid, SYS_setpgid,
    // who and where one is
    SYS_getpid, SYS_getppid, SYS_getpgid, SYS_getsid, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid, SYS_getresuid, SYS_getresgid,
    SYS_getgroups, SYS_capget, SYS_capset, SYS_prctl, SYS_seccomp, SYS_uname, SYS_sysinfo, SYS_getrusage, SYS_getrlimit, SYS_setrlimit,
    SYS_prlimit64, SYS_getrandom,
#ifdef __x86_64__
    SYS_epoll_wait, SYS_poll, SYS_select, SYS_open, SYS_creat, SYS_stat, SYS_lstat, SYS_access, SYS_readlink, SYS_getdents, SYS_mkdir, SYS_rmdir,
    SYS_unlink, SYS_rename, SYS_link, SYS_symlink, SYS_chmod, SYS_utime, SYS_utimes, SYS_futimesat, SYS_dup2, SYS_pipe, SYS_epoll_create,
    SYS_eventfd, SYS_signalfd, SYS_inotify_init, SYS_alarm, SYS_pause, SYS_time, SYS_getpgrp, SYS_arch_prctl,
#endif
};
/// LeakSanitizer traces its own process in a child, and reports run a symbolizer.
inline constexpr long kAllowedUnderSanitizers[] = {
    SYS_ptrace, SYS_process_vm_readv, SYS_execve, SYS_execveat,
#ifdef __x86_64__
    SYS_fork, SYS_vfork,
#endif
};
// clang-format on

} // namespace gridspace
