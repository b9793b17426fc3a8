// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/connections.hpp"
#include "monitor/web/tls.hpp"

#include <algorithm>
#include <future>

namespace gridspace::web {
namespace {

constexpr std::size_t kLeaving = 64; ///< connections beyond the limit that are told so

} // namespace

ServerImpl::ServerImpl(Options options, Handlers handlers, Gate gate, std::optional<asio::ssl::context> tls)
    : options_{std::move(options)}, handlers_{std::move(handlers)}, gate_{std::move(gate)}, tls_{std::move(tls)},
      acceptor_{context_} {}

ServerImpl::~ServerImpl() {
    asio::post(context_, [this] {
        ending_ = true;
        boost::system::error_code ignored;
        acceptor_.close(ignored);
        for (Closable* connection : std::set<Closable*>{connections_}) {
            connection->close();
        }
    });
    if (thread_.joinable()) {
        thread_.join(); // the context runs dry when all connections are gone
    }
}

Result<void> ServerImpl::open(UniqueFd listening) {
    boost::system::error_code error;
    acceptor_.assign(tcp::v4(), listening.get(), error);
    if (error) {
        return fail(ExitCode::environment, "the socket to serve on does not work: " + error.message());
    }
    (void)listening.release();
    accept();
    thread_ = std::thread{[this] { serve(); }};
    return {};
}

void ServerImpl::serve() {
    while (!guarded("the work for a client", [this] { context_.run(); })) { // it goes on with the next one's
    }
}

void ServerImpl::push(ClientId client, Message message) {
    {
        std::lock_guard const lock{mutex_};
        auto const it = tallies_.find(client);
        if (it == tallies_.end()) {
            return; // it has left
        }
        ++it->second.waiting.messages;
        it->second.waiting.octets += message.octets->size();
    }
    asio::post(context_, [this, client, message = std::move(message)]() mutable {
        if (auto const it = clients_.find(client); it != clients_.end()) {
            it->second->push(std::move(message));
        }
    });
}

void ServerImpl::drain(std::chrono::milliseconds patience) {
    auto const deadline = std::chrono::steady_clock::now() + patience;
    auto drained = [this] {
        std::promise<bool> answer;
        auto future = answer.get_future();
        asio::post(context_, [&] { // behind whatever was pushed
            answer.set_value(std::all_of(clients_.begin(), clients_.end(),
                                         [](auto const& entry) { return entry.second->has_sent_everything(); }));
        });
        return future.get();
    };
    while (!drained() && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
}

void ServerImpl::accept() {
    acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
        if (ending_ || error == asio::error::operation_aborted) {
            return;
        }
        if (!error) {
            if (connections_.size() >= options_.limits.connections) {
                count([](ServerCounters& c) { ++c.refused; });
                if (!idle_.empty()) {
                    idle_.front()->close(); // whoever waits longest without asking anything makes room
                }
            }
            // A few beyond the limit are on their way out; more than that are not let in.
            if (connections_.size() < options_.limits.connections + kLeaving) {
                guarded("a new connection", [&] {
                    std::make_shared<HttpSession>(*this, Transport{std::move(socket), tls_ ? &*tls_ : nullptr})
                        ->start();
                });
            }
        }
        accept();
    });
}

Result<std::unique_ptr<Server>> Server::start(UniqueFd listening, Options options, Handlers handlers) {
    std::string const where = address_of(listening);
    if (auto ok = check_exposure(where, !options.tokens.empty(), options.tls.has_value()); !ok) {
        return std::unexpected{ok.error()};
    }
    std::optional<asio::ssl::context> tls;
    if (options.tls) {
        auto context = load_tls(*options.tls);
        if (!context) {
            return std::unexpected{context.error()};
        }
        for (std::string& name : names_of(context->get())) {
            options.sites.hosts.push_back(std::move(name)); // whoever asks by it has been shown that it is us
        }
        tls.emplace(context->release()); // it is freed there
    }
    auto session = make_secret();
    if (!session) {
        return std::unexpected{session.error()};
    }
    auto const port = static_cast<std::uint16_t>(std::stoul(where.substr(where.rfind(':') + 1)));
    Gate gate{options.tokens, std::move(*session), port, options.tls.has_value()};
    auto server =
        std::make_unique<ServerImpl>(std::move(options), std::move(handlers), std::move(gate), std::move(tls));
    if (auto ok = server->open(std::move(listening)); !ok) {
        return std::unexpected{ok.error()};
    }
    return server;
}

} // namespace gridspace::web
