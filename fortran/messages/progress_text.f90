!> The progress of a run as one line: for terminals, for logs, for programs.
module lopin_progress_text
   use lopin_kinds, only : wp
   use lopin_render, only : json_string
   use lopin_report, only : verdict_words
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_watcher, only : news_type, event_of
   implicit none
   private
   public :: pace_type, share_done, live_line, plain_line, json_line, is_due, clock_text

   integer, parameter :: bar = 20              !! places of the bar
   !> Lines of a log come after so many seconds, and then at twice the time, but never more rarely
   !> than the last.
   real(wp), parameter :: first_line = 5.0_wp, rarest = 60.0_wp
   !> Increments grow: the first ones say nothing of the time that is left.
   real(wp), parameter :: enough_to_say = 0.02_wp

   !> How fast a run goes.
   type :: pace_type
      real(wp) :: elapsed = 0.0_wp             !! since it began or went on [s]
      real(wp) :: began_at = 0.0_wp            !! share of the run that was done then [-]
      integer :: cuts = 0                      !! increments cut since then
   end type pace_type

contains

   !> Share of the whole run that is accepted.
   pure real(wp) function share_done(news) result(share)
      type(news_type), intent(in) :: news

      share = 0.0_wp
      if (news%whole_time > 0.0_wp) share = news%total_time/news%whole_time
      share = min(max(share, 0.0_wp), 1.0_wp)
   end function share_done

   !> Seconds that are left at this pace; negative where nobody knows.
   pure real(wp) function time_left(news, pace) result(left)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      real(wp) :: done

      left = -1.0_wp
      done = share_done(news) - pace%began_at
      if (done > 0.0_wp) left = pace%elapsed*(1.0_wp - share_done(news))/done
   end function time_left

   !> One line that fits between the margins of a terminal.
   pure function live_line(news, pace, columns) result(text)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      integer, intent(in) :: columns           !! of the terminal
      character(len=:), allocatable :: text
      integer :: full

      full = nint(bar*share_done(news))
      text = 'step '//to_text(news%step)//'/'//to_text(news%steps)//' ['//repeat('#', full)// &
         & repeat('.', bar - full)//'] '//per_cent(news)//left_text(news, pace)//', '// &
         & where_it_is(news, pace)
      if (len(text) >= columns) text = text(:max(0, columns - 1))
   end function live_line

   !> The same for a log.
   pure function plain_line(news, pace) result(text)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      character(len=:), allocatable :: text

      text = clock_text(pace%elapsed)//'  step '//to_text(news%step)//'/'//to_text(news%steps)// &
         & ', '//per_cent(news)//left_text(news, pace)//', '//where_it_is(news, pace)
   end function plain_line

   pure function per_cent(news) result(text)
      type(news_type), intent(in) :: news
      character(len=:), allocatable :: text
      character(len=4) :: number

      write (number, '(i3, a)') int(100.0_wp*share_done(news)), '%'
      text = number
   end function per_cent

   pure function left_text(news, pace) result(text)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      character(len=:), allocatable :: text

      text = ''
      if (share_done(news) - pace%began_at >= enough_to_say .and. share_done(news) < 1.0_wp) &
         & text = ', '//clock_text(time_left(news, pace))//' left'
   end function left_text

   !> Increment and its size, iterations, contacts, cuts.
   pure function where_it_is(news, pace) result(text)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      character(len=:), allocatable :: text

      text = 'increment '//to_text(news%increment)
      if (news%attempt > 1) text = text//' (attempt '//to_text(news%attempt)//')'
      text = text//' (+'//to_text(news%time_increment, 3)//')'
      if (news%iterations > 0) text = text//', '//plural(news%iterations, 'iteration')
      text = text//', '//plural(news%closed, 'contact')
      if (pace%cuts > 0) text = text//', '//plural(pace%cuts, 'cut')
   end function where_it_is

   !> 75 s as 1:15.
   pure function clock_text(seconds) result(text)
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text
      character(len=24) :: buffer
      integer :: s

      s = nint(min(seconds, 1.0e8_wp))
      if (s < 3600) then
         write (buffer, '(i0, ":", i2.2)') s/60, mod(s, 60)
      else
         write (buffer, '(i0, 2(":", i2.2))') s/3600, mod(s/60, 60), mod(s, 60)
      end if
      text = trim(buffer)
   end function clock_text

   !> A JSON object in a line; '' of what programs are not told.
   function json_line(news, pace) result(text)
      type(news_type), intent(in) :: news
      type(pace_type), intent(in) :: pace
      character(len=:), allocatable :: text

      text = ''
      if (news%event == event_of%plan) then
         text = '{"event": "plan", "plan": '//json_string(news%text)//'}'
         return
      end if
      if (all(news%event /= [event_of%cut, event_of%increment])) return
      text = '{"event": "'//trim(merge('cut      ', 'increment', news%event == event_of%cut))// &
         & '", "step": '//to_text(news%step)//', "steps": '//to_text(news%steps)// &
         & ', "increment": '//to_text(news%increment)//', "attempt": '//to_text(news%attempt)// &
         & ', "step_time": '//to_text(news%step_time)//', "total_time": '// &
         & to_text(news%total_time)//', "time_increment": '//to_text(news%time_increment)// &
         & ', "done": '//to_text(share_done(news))//', "cuts": '//to_text(pace%cuts)// &
         & ', "elapsed": '//to_text(pace%elapsed)
      if (time_left(news, pace) >= 0.0_wp) text = text//', "left": '// &
         & to_text(time_left(news, pace))
      if (news%event == event_of%cut) then
         text = text//', "because": '//json_string(news%text)//'}'
      else
         text = text//', "iterations": '//to_text(news%iterations)//', "closed": '// &
            & to_text(news%closed)//', "max_pressure": '//to_text(news%pressure)// &
            & ', "verdict": "'//trim(verdict_words(news%verdict))//'"}'
      end if
   end function json_line

   !> Is a line of a log due, after the one that was written at `last`?
   pure logical function is_due(elapsed, last)
      real(wp), intent(in) :: elapsed          !! since the run began [s]
      real(wp), intent(in) :: last             !! of the line before; 0: none yet [s]

      is_due = elapsed >= max(first_line, min(2.0_wp*last, last + rarest))
   end function is_due
end module lopin_progress_text
