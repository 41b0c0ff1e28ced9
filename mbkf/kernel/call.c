/* Working memory and refusals, one of each per thread, since long calls run without the interpreter's lock. */
#include "call.h"

#include <stdlib.h>

#if defined(_MSC_VER)
#define THREAD_LOCAL __declspec(thread)
#else
#define THREAD_LOCAL _Thread_local
#endif

const char out_of_memory[] = "no memory is left";

static THREAD_LOCAL const char *refusal;
static THREAD_LOCAL double *memory;
static THREAD_LOCAL long size;

double *workspace(long count)
{
#ifdef MBKF_SANITIZE /* the sanitizer sees a call that leaves memory of exactly the size it asked for */
    size = 0;
#endif
    if (!memory || count > size) {
        free(memory);
        memory = malloc(sizeof *memory * (count > 0 ? count : 1));
        size = memory ? count : 0;
        if (!memory)
            refuse(out_of_memory);
    }
    return memory;
}

void refuse(const char *reason) { refusal = reason; }

const char *taken_refusal(void)
{
    const char *reason = refusal;
    refusal = NULL;
    return reason;
}
