/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines shared out: to the threads of a process by OpenMP, and under mpirun to processes, of which number r of n takes
 * rows r, r + n, ... and sends their lines to the first. Only one thread at a time speaks to the others. */
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif
#ifdef HAVE_MPI
#include <mpi.h>
#endif

enum { LINES_AT_ONCE = 64, LINES_ON_DEVICE = 1 << 14 };

struct share {
	struct workers workers;
	const struct lines_wanted *of;
	size_t awaited;                         /* lines that other processes owe the first */
};

#ifdef HAVE_MPI

/* One line from another process; false: none has come, and `wait` is not set */
static bool receive(struct share *s, bool wait)
{
	MPI_Status status;
	int length, there = 1;
	if (wait)
		MPI_Probe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &status);
	else
		MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &status);
	if (!there)
		return false;
	MPI_Get_count(&status, MPI_BYTE, &length);
	char *message = need(malloc((size_t)length));
	uint64_t row;
	MPI_Recv(message, length, MPI_BYTE, status.MPI_SOURCE, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
	memcpy(&row, message, sizeof row);
	s->of->deliver(s->of->who, (size_t)row, format("%s", message + sizeof row));
	s->awaited--;
	free(message);
	return true;
}

/* The row's number, then the line with its 0 */
static void send(size_t row, char *line)
{
	uint64_t number = row;
	size_t length = strlen(line) + 1;
	char *message = need(malloc(sizeof number + length));
	memcpy(message, &number, sizeof number);
	memcpy(message + sizeof number, line, length);
	MPI_Send(message, (int)(sizeof number + length), MPI_BYTE, 0, 0, MPI_COMM_WORLD);
	free(message);
	free(line);
}

/* Which rows are done is known to the first, which has the journal. */
static void agree_on_done(const struct share *s, char *done)
{
	const size_t rows = s->of->rows;
	for (size_t i = 0; i < rows; i += 1 << 30) {
		size_t part = rows - i < 1 << 30 ? rows - i : 1 << 30;
		MPI_Bcast(done + i, (int)part, MPI_BYTE, 0, MPI_COMM_WORLD);
	}
}

static bool begun;

struct workers workers_begin(int *argc, char ***argv)
{
	struct workers w = { 0, 1 };
	int level;
	if (!getenv("OMPI_COMM_WORLD_SIZE") && !getenv("PMI_SIZE"))
		return w;               /* not under mpirun: nothing has to be started */
	MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
	begun = true;
	MPI_Comm_rank(MPI_COMM_WORLD, &w.rank);
	MPI_Comm_size(MPI_COMM_WORLD, &w.size);
	if (level < MPI_THREAD_SERIALIZED)
		fail(WRONG_DATA, "this MPI bears no threads");
	return w;
}

void workers_end(void)
{
	if (begun)
		MPI_Finalize();
}

#else

static bool receive(struct share *s, bool wait) { return (void)s, (void)wait, false; }
static void send(size_t row, char *line) { (void)row, (void)line; }
static void agree_on_done(const struct share *s, char *done) { (void)s, (void)done; }

struct workers workers_begin(int *argc, char ***argv)
{
	(void)argc, (void)argv;
	const char *size = getenv("OMPI_COMM_WORLD_SIZE");
	if (size && strcmp(size, "1") != 0)
		fail(WRONG_USAGE, "this plrun was built without MPI: each of these processes would run everything");
	return (struct workers){ 0, 1 };
}

void workers_end(void)
{
}

#endif

static void hand_over(struct share *s, size_t row, char *line)
{
	if (s->workers.rank != 0) {
		send(row, line);
		return;
	}
	s->of->deliver(s->of->who, row, line);
	while (s->awaited && receive(s, false))
		;
}

/* As many lines at a time as go side by side, and few enough that all threads have some to the end */
static void run_own(struct share *s, const size_t *own, size_t count)
{
#ifdef _OPENMP
	const int threads = s->of->jobs ? s->of->jobs : omp_get_max_threads();
#else
	const int threads = 1;
	if (s->of->jobs > 1)
		wrong_usage("this plrun was built without OpenMP: one job at a time");
#endif
	const bool device = s->of->device;
	const size_t each = device ? count / (size_t)threads + 1 : count / (size_t)threads / 4 + 1;
	const size_t most = device ? LINES_ON_DEVICE : LINES_AT_ONCE, some = each < most ? each : most;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
#endif
	for (size_t i = 0; i < count; i += some) {
		const size_t n = count - i < some ? count - i : some;
		char **line = need(calloc(n, sizeof *line));
		s->of->compute(s->of->who, own + i, n, line);
		for (size_t k = 0; k < n; k++)
#ifdef _OPENMP
#pragma omp critical(hand_over)
#endif
			hand_over(s, own[i + k], line[k]);
		free(line);
	}
}

void workers_share(struct workers w, const struct lines_wanted *of)
{
	struct share s = { w, of, 0 };
	char *done = need(calloc(of->rows + 1, 1));
	size_t *own = need(calloc(of->rows + 1, sizeof *own)), count = 0;
	for (size_t i = 0; i < of->rows; i++)
		done[i] = of->line[i] != NULL;
	if (w.size > 1)
		agree_on_done(&s, done);
	for (size_t i = 0; i < of->rows; i++) {
		if (done[i])
			continue;
		if ((int)(i % (size_t)w.size) == w.rank)
			own[count++] = i;
		else
			s.awaited++;
	}
	run_own(&s, own, count);
	while (w.rank == 0 && s.awaited && receive(&s, true))
		;
	free(done);
	free(own);
}
