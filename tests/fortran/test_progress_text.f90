!> Where a run is, in a line for terminals, logs and programs.
program test_progress_text
   use lopin_kinds, only : wp
   use lopin_progress_text, only : pace_type, share_done, live_line, plain_line, json_line, &
      & is_due, clock_text
   use lopin_watcher, only : news_type, event_of
   use check, only : test, is_true, equal_text, close_to, finish
   implicit none

   type(news_type) :: news
   type(pace_type) :: pace
   character(len=:), allocatable :: text

   news = news_type(event=event_of%increment, step=2, steps=3, increment=14, attempt=2, &
      & iterations=4, closed=41, total_time=1.5_wp, whole_time=3.0_wp, step_time=0.5_wp, &
      & time_increment=0.025_wp, verdict=1, text='')
   pace = pace_type(elapsed=60.0_wp, cuts=1)

   call test('a line says step, share, time left, increment, iterations, contacts, cuts')
   call close_to('share', share_done(news), 0.5_wp, 1.0e-15_wp)
   call equal_text('live', live_line(news, pace, 120), 'step 2/3 [##########..........]  50%, '// &
      & '1:00 left, increment 14 (attempt 2) (+0.025), 4 iterations, 41 contacts, 1 cut')
   call equal_text('plain', plain_line(news, pace), '1:00  step 2/3,  50%, 1:00 left, '// &
      & 'increment 14 (attempt 2) (+0.025), 4 iterations, 41 contacts, 1 cut')

   call test('a line on a terminal is shorter than the terminal is wide')
   text = live_line(news, pace, 40)
   call is_true('length', len(text) == 39)
   call is_true('no width', len(live_line(news, pace, 0)) == 0)

   call test('a run that goes on reckons from where it went on')
   pace%began_at = 0.25_wp
   text = plain_line(news, pace)
   call is_true('twice as long', index(text, '2:00 left') > 0)
   pace%began_at = 0.49_wp
   text = plain_line(news, pace)
   call is_true('too early to say', index(text, 'left') == 0)

   call test('times are read as on a clock')
   call equal_text('seconds', clock_text(4.6_wp), '0:05')
   call equal_text('hours', clock_text(3661.0_wp), '1:01:01')

   call test('a log gets a line after 5, 10, 20, 40, 80, 140 s and then every minute')
   call is_true('none at once', .not. is_due(4.9_wp, 0.0_wp))
   call is_true('first', is_due(5.0_wp, 0.0_wp))
   call is_true('twice the time', .not. is_due(9.9_wp, 5.0_wp) .and. is_due(10.0_wp, 5.0_wp))
   call is_true('every minute', .not. is_due(139.0_wp, 80.0_wp) .and. is_due(140.0_wp, 80.0_wp))

   call test('programs get one object a line')
   pace = pace_type(elapsed=60.0_wp)
   text = json_line(news, pace)
   call is_true('event', index(text, '{"event": "increment", "step": 2, "steps": 3,') == 1)
   call is_true('verdict', index(text, '"verdict": "WARN"}') > 0)
   news%event = event_of%iteration
   call equal_text('nothing of iterations', json_line(news, pace), '')
   call finish()
end program test_progress_text
