// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class FormatterBase;
}

namespace gridspace::cli {

/// How help is laid out: what a verb is for, examples, how it is called, then its options by group. The name of an
/// option says what kind of value it takes, and no more: ranges are said by the error.
std::shared_ptr<CLI::FormatterBase> help_formatter();

/// What `gridspace` says that is called with nothing: a first command, and the verbs of every day.
std::string_view first_help();

} // namespace gridspace::cli
