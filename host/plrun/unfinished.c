/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes when plrun is ended before its time, by a signal or by what is wrong: programs that it has started, with
 * all that they have started, and folders and files that are not done.
 *
 * Signals are waited for by a thread of their own, so that what has to be done then is done as anywhere else; whoever
 * begins or ends something holds the lock, which an end never gives back. */
#define _GNU_SOURCE
#include "plrun.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct unfinished *first;
static const char *last_words;
static sigset_t awaited;

void unfinished_begins(void)
{
	pthread_mutex_lock(&lock);
}

void unfinished_is(struct unfinished *u)
{
	if (u) {
		u->next = first;
		first = u;
	}
	pthread_mutex_unlock(&lock);
}

void unfinished_ends(struct unfinished *u)
{
	struct unfinished **link = &first;
	pthread_mutex_lock(&lock);
	while (*link && *link != u)
		link = &(*link)->next;
	if (*link)
		*link = u->next;
	pthread_mutex_unlock(&lock);
}

/* Half a second for the last of them, so that nothing writes into a folder that goes */
static void end_programs(void)
{
	for (struct unfinished *u = first; u; u = u->next)
		if (u->group)
			kill(-u->group, SIGTERM);
	for (struct unfinished *u = first; u; u = u->next)
		for (int i = 0; u->group && i < 50 && kill(-u->group, 0) == 0; i++)
			usleep(10000);
}

static void take_along(void)
{
	pthread_mutex_lock(&lock);
	end_programs();
	for (struct unfinished *u = first; u; u = u->next)
		if (u->remove)
			u->remove(u->path);
}

static void *wait_for_signal(void *none)
{
	int number;
	if (sigwait(&awaited, &number) != 0)
		return none;
	take_along();
	if (last_words && write(STDERR_FILENO, last_words, strlen(last_words)) < 0)
		last_words = NULL;
	signal(number, SIG_DFL);
	pthread_sigmask(SIG_UNBLOCK, &awaited, NULL);
	raise(number);
	return none;
}

void say_when_interrupted(const char *text)
{
	last_words = text;
}

/* A signal that is ignored, as that of a terminal behind nohup, stays ignored. */
void watch_for_signals(void)
{
	static const int ending[] = { SIGHUP, SIGINT, SIGTERM };
	struct sigaction action;
	pthread_t thread;
	sigemptyset(&awaited);
	for (size_t i = 0; i < sizeof ending / sizeof *ending; i++)
		if (sigaction(ending[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN)
			sigaddset(&awaited, ending[i]);
	pthread_sigmask(SIG_BLOCK, &awaited, NULL);
	atexit(take_along);
	if (pthread_create(&thread, NULL, wait_for_signal, NULL) != 0)
		fail(WRONG_DATA, "no thread can be started");
	pthread_detach(thread);
}
