// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Linked into every program and test of an AddressSanitizer build, and into nothing else.

/// Fast DDS 2.9.1 (Debian) deletes some of its objects as a base class without a virtual destructor; the mismatch is
/// its own.
extern "C" char const* __asan_default_options() { // NOLINT: the name is the sanitizer's
    return "new_delete_type_mismatch=0:detect_stack_use_after_return=1";
}
