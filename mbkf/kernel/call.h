/* A kernel function's working memory, and its refusal of a call. */
#ifndef MBKF_CALL_H
#define MBKF_CALL_H

/* Memory of this thread for so many numbers, until the next call asks; NULL where there is none. It stays from call to
 * call, since fresh pages cost more than the work. */
double *workspace(long count);

/* Makes the call from Python raise a ValueError with this reason when the function returns. */
void refuse(const char *reason);

/* The reason since the last time this was asked; NULL if there is none. */
const char *taken_refusal(void);

extern const char out_of_memory[];

#endif
