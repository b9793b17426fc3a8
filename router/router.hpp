// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "router/end.hpp"
#include "router/route_table.hpp"

#include <map>
#include <set>
#include <tuple>

namespace gridspace::router {

/// Called with what the router does, for people and for programs.
class Reporter {
  public:
    virtual ~Reporter() = default;
    virtual void site(std::string const& end, std::string const& name, bool here, bool clean) = 0;
    virtual void carries(Route const& route, RouterConfig const& config, bool now) = 0;
    virtual void note(std::string const& text) = 0;
    virtual void total(std::string const& topic, std::string const& from, std::string const& to, std::uint64_t samples,
                       std::uint64_t octets, std::uint64_t refused, std::uint64_t dropped) = 0;
};

/// Joins the ends and carries the allowed topics.
class Router {
  public:
    Router(RouterConfig const& config, Reporter& reporter);
    ~Router();
    /// `wake` is called, from threads of DDS, when update() has something to do.
    [[nodiscard]] Result<void> open(std::filesystem::path const& qos_file, std::function<void()> wake);
    /// Opens and closes routes after what was discovered; from one thread.
    void update();
    /// Notes every link to somebody who has not answered so far.
    void note_silent_links();
    /// Ends all routes, writes what waits, and reports the totals.
    void close();

  private:
    struct Watch;
    struct Carried {
        Route route;
        std::string type; ///< codecs refer to it
        std::unique_ptr<bus::RawReader> reader;
        std::vector<std::pair<std::size_t, std::shared_ptr<Lane>>> lanes; ///< by end
    };
    void open_route(Route route);
    void close_route(Carried& carried);
    void listen_for_types(std::size_t end);
    void publish_types();
    void keep_type(std::string const& type, std::string const& idl); ///< mutex held
    [[nodiscard]] std::string idl_of(std::string const& type);

    RouterConfig const& config_;
    Reporter& reporter_;
    std::function<void()> wake_;
    std::mutex mutex_; // guards the next three
    RouteTable table_;
    std::map<std::string, std::string> idl_;     ///< by type, as heard
    std::size_t idl_octets_{0};                  ///< of all of them
    bool types_are_full_{false};                 ///< has been said
    std::vector<std::function<void()>> reports_; ///< of threads of DDS, to be made by update()

    std::vector<std::unique_ptr<Watch>> watches_;
    std::vector<std::unique_ptr<End>> ends_;
    std::vector<std::unique_ptr<bus::RawReader>> type_readers_;
    std::vector<std::unique_ptr<Carried>> carried_;
    std::vector<std::set<std::string>> published_;                              ///< types, by end
    std::set<std::string> refused_;                                             ///< routes that DDS refused, said once
    std::map<std::tuple<std::string, std::size_t, std::size_t>, Total> totals_; ///< of topic, from, to
};

} // namespace gridspace::router
