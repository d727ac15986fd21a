!> The contract of watchers (observers) of a run: told of each attempt, iteration, cut and
!> increment.
!>
!> A watcher never changes the run; recorders keep what a watcher only sees.
module lopin_watcher
   use lopin_kinds, only : wp
   implicit none
   private
   public :: watcher_type, news_type, event_of

   type :: events
      integer :: plan = 1, attempt = 2, iteration = 3, cut = 4, increment = 5
   end type events
   type(events), parameter :: event_of = events()

   !> Where a run is.
   type :: news_type
      integer :: event = 0                     !! one of `event_of`
      integer :: step = 0, steps = 0           !! the present one, of so many
      integer :: increment = 0, attempt = 1
      integer :: iterations = 0                !! of the present attempt
      integer :: closed = 0                    !! slave points in contact
      real(wp) :: total_time = 0.0_wp          !! accepted so far [time]
      real(wp) :: whole_time = 1.0_wp          !! of all steps [time]
      real(wp) :: step_time = 0.0_wp           !! accepted so far in the step [time]
      real(wp) :: period = 1.0_wp              !! of the step [time]
      real(wp) :: time_increment = 0.0_wp      !! that is tried, or was accepted [time]
      real(wp) :: pressure = 0.0_wp            !! largest of contact, of an increment [stress]
      integer :: verdict = 0                   !! index into verdict_words, of an increment
      character(len=:), allocatable :: text    !! the plan, or why an attempt is cut
   end type news_type

   type, abstract :: watcher_type
   contains
      procedure(look_if), deferred :: look
   end type watcher_type

   abstract interface
      subroutine look_if(self, news)
         import :: watcher_type, news_type
         class(watcher_type), intent(inout) :: self
         type(news_type), intent(in) :: news
      end subroutine look_if
   end interface
end module lopin_watcher
