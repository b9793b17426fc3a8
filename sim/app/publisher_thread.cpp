// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/publisher_thread.hpp"

#include <utility>

namespace gridspace::sim {

PublisherThread::PublisherThread(std::function<Result<void>(SimTime, bool)> publish) : publish_{std::move(publish)} {
    thread_ = std::thread{[this] { loop(); }};
}

PublisherThread::~PublisherThread() {
    stop_ = true;
    ++bell_;
    bell_.notify_one();
    if (thread_.joinable()) {
        thread_.join();
    }
}

bool PublisherThread::tick_ended(SimTime end, bool final) {
    if (failed_ || !ticks_.push({end, final})) {
        return false;
    }
    ++bell_;
    bell_.notify_one();
    return true;
}

Result<void> PublisherThread::finish() {
    thread_.join(); // it ends behind the final tick, or when it fails
    return error_ ? Result<void>{std::unexpected{*error_}} : Result<void>{};
}

void PublisherThread::loop() {
    while (true) {
        std::uint32_t const heard = bell_.load();
        for (Tick tick; !stop_ && ticks_.pop(tick);) {
            if (auto ok = publish_(tick.end, tick.final); !ok) {
                error_ = ok.error();
                failed_ = true;
                return;
            }
            if (tick.final) {
                return;
            }
        }
        if (stop_) {
            return;
        }
        bell_.wait(heard);
    }
}

} // namespace gridspace::sim
