// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace gridspace::config {

/// A text that configuration was read from: a file, or a `--set` argument.
struct SourceText {
    std::string name;      ///< as the user wrote it; what diagnostics print
    std::string directory; ///< where relative paths of this text start
    std::vector<std::string> lines;
};

/// A place in a source. Lines and columns count from 1; 0 means "the text as a whole".
struct SourceMark {
    std::shared_ptr<SourceText const> source;
    int line{0};
    int column{0};

    [[nodiscard]] std::string to_string() const; ///< "file.yaml:42:15"
};

enum class Severity { error, warning };

struct Diagnostic {
    Severity severity{Severity::error};
    SourceMark where;
    std::string message;
    std::string hint; ///< printed beside the caret: what was expected, the nearest spelling
    int width{1};     ///< characters underlined
};

/// Collects everything that is wrong, so that a user sees all of it at once; of a file of mistakes the first thousand.
class Diagnostics {
  public:
    void error(SourceMark where, std::string message, std::string hint = {}, int width = 1);
    void warning(SourceMark where, std::string message, std::string hint = {}, int width = 1);

    [[nodiscard]] bool ok() const { return errors_ == 0; }
    [[nodiscard]] int errors() const { return errors_; }
    [[nodiscard]] int warnings() const { return warnings_; }
    [[nodiscard]] bool full() const;                      ///< what comes now is counted, and not kept
    [[nodiscard]] std::vector<Diagnostic> sorted() const; ///< by source, line, column; duplicates dropped

    /// The text for people: each item with its line and a caret, then "2 errors, 1 warning."
    [[nodiscard]] std::string render() const;

  private:
    std::vector<Diagnostic> items_;
    int errors_{0}, warnings_{0};
};

} // namespace gridspace::config
