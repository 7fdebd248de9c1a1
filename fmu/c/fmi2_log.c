/* The FMI 2.0 logger: expands the message's printf arguments and hands the text on. FMI 2.0 section 2.1.5. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* The head of the environment that the importer gives to the FMU (`Environment` in binding.rs). */
struct environment {
    void (*line)(const void *environment, int status, const char *category, const char *message);
};

void drivescope_fmi2_log(const struct environment *environment, const char *instance, int status,
                         const char *category, const char *message, ...)
{
    va_list arguments;
    (void)instance;
    if (!environment || !message)
        return;
    va_start(arguments, message);
    int length = vsnprintf(NULL, 0, message, arguments);
    va_end(arguments);
    char *text = length < 0 ? NULL : malloc((size_t)length + 1);
    if (!text)
        return;
    va_start(arguments, message);
    vsnprintf(text, (size_t)length + 1, message, arguments);
    va_end(arguments);
    environment->line(environment, status, category, text);
    free(text);
}
