// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "monitor/web/server.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::web {

/// Admits clients with a token. A program sends it with each request (`Authorization: Bearer TOKEN`); a browser gets
/// a page that asks for it once, and then a cookie that holds a secret of this process and not the token. A token in an
/// address opens a WebSocket and nothing else: programs that know of no headers (Foxglove, PlotJuggler) have no other
/// way, but addresses end in histories and logs.
class Gate {
  public:
    /// Without tokens it stands open. `secure`: the cookie goes over TLS only.
    Gate(std::vector<std::string> tokens, std::string session, std::uint16_t port, bool secure);

    [[nodiscard]] bool admits(std::string_view authorization, std::string_view cookie) const;
    /// A WebSocket client may also name the token in its address, `?token=TOKEN`. It is taken out of `target`.
    [[nodiscard]] bool admits_push(std::string_view authorization, std::string_view cookie, Target& target) const;
    /// What is answered in place of what was asked for; nothing for whoever is let in.
    [[nodiscard]] std::optional<Response> check(Request const& request) const;

  private:
    [[nodiscard]] bool is_token(std::string_view text) const;
    [[nodiscard]] Response login(Request const& request) const;

    std::vector<std::string> tokens_;
    std::string session_, cookie_; ///< value and name of the cookie
    bool secure_;
};

/// 32 hexadecimal digits that nobody can guess.
[[nodiscard]] Result<std::string> make_secret();
/// The first line of a file that nobody but its owner can read, of at least 16 characters.
[[nodiscard]] Result<std::string> read_token(std::filesystem::path const& file);

} // namespace gridspace::web
