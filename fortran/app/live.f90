!> The progress display of a run: one rewritten line on a terminal, an occasional line in a log, one
!> line per increment for programs.
module lopin_live
   use, intrinsic :: iso_c_binding, only : c_int, c_long_long
   use lopin_checked_file, only : write_all
   use lopin_interrupt, only : is_interrupted
   use lopin_kinds, only : wp, lk
   use lopin_progress_text, only : pace_type, share_done, live_line, plain_line, json_line, is_due
   use lopin_safe_text, only : printable
   use lopin_watcher, only : watcher_type, news_type, event_of
   implicit none
   private
   public :: live_type, new_live, form_of, form_words, clear_line

   type :: forms
      integer :: auto = 1, line = 2, plain = 3, json = 4, none = 5
   end type forms
   type(forms), parameter :: form_of = forms()
   character(len=*), parameter :: form_words(5) = [character(len=5) :: 'auto', 'line', 'plain', &
      & 'json', 'none']

   character(len=1), parameter :: nl = achar(10)
   !> Back to the first column, and nothing from there on.
   character(len=*), parameter :: clear_line = achar(13)//achar(27)//'[K'
   integer(c_int), parameter :: output_stream = 1, error_stream = 2
   real(wp), parameter :: pause = 0.1_wp       !! between two states of the line [s]

   type, extends(watcher_type) :: live_type
      private
      integer, public :: form = form_of%none
      logical :: each = .false.                !! a line for each increment
      logical :: tells_plan = .true.
      type(pace_type) :: pace
      integer(lk) :: began = -1                !! tick of the first news
      real(wp) :: shown = -1.0_wp              !! when the line was written last [s]
      integer :: closed = 0                    !! contacts of the last increment
      character(len=:), allocatable :: plan    !! that was told
   contains
      procedure :: look
   end type live_type

   interface
      integer(c_int) function columns_of(file) bind(c, name='lopin_columns')
         import :: c_int
         integer(c_int), value :: file
      end function columns_of
   end interface

contains

   !> The form that was asked for, or what suits where standard error goes.
   subroutine new_live(self, form, verbosity, json)
      type(live_type), intent(out) :: self
      integer, intent(in) :: form              !! one of `form_of`
      integer, intent(in) :: verbosity         !! 0 quiet, 1 normal, 2 a line for each increment
      logical, intent(in) :: json              !! nothing but an object at the end
      logical :: rewrites

      rewrites = columns_of(error_stream) > 0
      self%form = form
      self%plan = ''
      self%each = form == form_of%plain
      self%tells_plan = verbosity > 0 .and. .not. json
      if (form == form_of%auto) then
         self%form = form_of%plain
         self%each = verbosity > 1
         if (rewrites .and. .not. self%each) self%form = form_of%line
         if (verbosity == 0 .or. json) self%form = form_of%none
      end if
      if (self%form == form_of%line .and. .not. rewrites) self%form = form_of%plain
   end subroutine new_live

   subroutine look(self, news)
      class(live_type), intent(inout) :: self
      type(news_type), intent(in) :: news
      type(news_type) :: at

      call keep_pace(self, news)
      if (news%event == event_of%plan) call tell_plan(self, news)
      if (self%form == form_of%json) then
         call put(self, output_stream, json_line(news, self%pace), nl)
         return
      end if
      if (news%event == event_of%plan .or. news%event == event_of%cut) return
      at = news
      if (news%event == event_of%increment) self%closed = news%closed
      if (news%event == event_of%attempt) at%closed = self%closed
      if (self%form == form_of%line) call rewrite(self, at)
      if (self%form /= form_of%plain) return
      if (self%each) then
         if (news%event /= event_of%increment) return
      else if (.not. is_due(self%pace%elapsed, max(self%shown, 0.0_wp))) then
         return
      end if
      self%shown = self%pace%elapsed
      call put(self, error_stream, plain_line(at, self%pace), nl)
   end subroutine look

   !> Time since the first news, and the cuts among them.
   subroutine keep_pace(self, news)
      class(live_type), intent(inout) :: self
      type(news_type), intent(in) :: news
      integer(lk) :: now, rate

      call system_clock(now, rate)
      if (self%began < 0) then
         self%began = now
         self%pace%began_at = share_done(news)
      end if
      self%pace%elapsed = real(now - self%began, wp)/real(rate, wp)
      if (news%event == event_of%cut) self%pace%cuts = self%pace%cuts + 1
   end subroutine keep_pace

   !> The plan is said when it is made, and again if it becomes another.
   subroutine tell_plan(self, news)
      class(live_type), intent(inout) :: self
      type(news_type), intent(in) :: news

      if (.not. self%tells_plan .or. self%form == form_of%json .or. news%text == self%plan) return
      self%plan = news%text
      if (self%form == form_of%line) call put(self, error_stream, clear_line, '')
      call put(self, output_stream, printable(news%text), nl)
   end subroutine tell_plan

   subroutine rewrite(self, news)
      class(live_type), intent(inout) :: self
      type(news_type), intent(in) :: news
      character(len=:), allocatable :: text

      if (self%shown >= 0.0_wp .and. self%pace%elapsed < self%shown + pause) return
      self%shown = self%pace%elapsed
      text = live_line(news, self%pace, int(columns_of(error_stream)))
      if (is_interrupted()) text = 'ends with this iteration; increments are kept (Ctrl-C: at once)'
      call put(self, error_stream, clear_line//text, '')
   end subroutine rewrite

   !> Where nobody reads, nothing more is told.
   subroutine put(self, stream, text, line_end)
      class(live_type), intent(inout) :: self
      integer(c_int), intent(in) :: stream
      character(len=*), intent(in) :: text, line_end

      if (len(text) == 0) return
      if (write_all(stream, text//line_end, len(text//line_end, kind=c_long_long)) /= 0) &
         & self%form = form_of%none
   end subroutine put
end module lopin_live
