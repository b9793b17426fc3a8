# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Debian's cross compiler for ARM64 against packages unpacked in build/arm64-sysroot (scripts/arm64.sh makes that link).
# Programs of the target (tests) run under qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

get_filename_component(GRIDSPACE_ARM64_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../build/arm64-sysroot" REALPATH)
set(CMAKE_SYSROOT "${GRIDSPACE_ARM64_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH "${GRIDSPACE_ARM64_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${GRIDSPACE_ARM64_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR} "${GRIDSPACE_ARM64_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${GRIDSPACE_ARM64_SYSROOT}/usr/share/pkgconfig")

# Any ARMv8-A runs it; the order of instructions suits the Cortex-A53 (Odroid-C2, Raspberry Pi 3).
set(CMAKE_C_FLAGS_INIT "-march=armv8-a -mtune=cortex-a53")
set(CMAKE_CXX_FLAGS_INIT "-march=armv8-a -mtune=cortex-a53")

set(CMAKE_CROSSCOMPILING_EMULATOR "/usr/bin/qemu-aarch64-static;-L;${GRIDSPACE_ARM64_SYSROOT}")
