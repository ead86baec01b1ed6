// SPDX-License-Identifier: GPL-2.0-or-later
// Messages of a plugin go to stderr: YADE's own loggers need Boost.Log.
#pragma once

#include <iostream>

#define ANCF_LOG_LINE(level, message) (std::cerr << "ancf " level ": " << message << std::endl)
#define ANCF_LOG_NOTHING(message)                                                                                      \
    do {                                                                                                               \
        if (false) std::cerr << message;                                                                               \
    } while (false)

#define LOG_FATAL(message) ANCF_LOG_LINE("FATAL", message)
#define LOG_ERROR(message) ANCF_LOG_LINE("ERROR", message)
#define LOG_WARN(message) ANCF_LOG_LINE("WARNING", message)
#define LOG_INFO(message) ANCF_LOG_NOTHING(message)
#define LOG_DEBUG(message) ANCF_LOG_NOTHING(message)
#define LOG_TRACE(message) ANCF_LOG_NOTHING(message)

#define DECLARE_LOGGER static_assert(true)
#define CREATE_LOGGER(klass) static_assert(true)
