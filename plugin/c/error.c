#include "ancf/error.h"

const char* ancf_error_text(ancf_error code) {
    switch (code) {
#define ANCF_ERROR_CASE(name, text)                                                                                    \
    case name:                                                                                                         \
        return text;
        ANCF_ERRORS(ANCF_ERROR_CASE)
#undef ANCF_ERROR_CASE
    }
    return "unknown error";
}
