!> Loads of a step that go along a straight line: two forward passes serve all its increments.
!>
!> The condensed load of an increment is linear in its loads and prescribed values. Where these lie
!> on the line through those of the two ends of the step, so does it. The ends follow from the step
!> alone, so that a run which goes on from a checkpoint has the same bits.
module lopin_straight_loads
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_loading, only : loading_type, loads_at, prescribed_at
   implicit none
   private
   public :: straight_loads_type, follow_line

   !> A pass more pays where increments are at most this share of their step.
   real(wp), parameter :: pays = 0.25_wp

   !> Shares beyond this lose digits.
   real(wp), parameter :: farthest = 4.0_wp

   type :: straight_loads_type
      integer :: step = 0                      !! whose ends are known; 0: none
      logical :: fits = .false.                !! the increment in hand lies on their line
      logical :: ready = .false.               !! their passes were made, with the factor in force
      real(wp) :: share = 0.0_wp   !! of the way from the first end to the second; beyond 0 to 1 too
      integer :: most = 0                      !! load that changes most from end to end; 0: none
      real(wp), allocatable :: f(:, :)         !! (ndof, 2) loads [force]
      real(wp), allocatable :: prescribed(:, :)   !! (nprescribed, 2) [length], [rad]
      real(wp), allocatable :: y(:, :)         !! (n, 2) forward passes
      real(wp), allocatable :: load(:, :)      !! (nlast, 2) condensed loads [force]
      real(wp), allocatable :: moving(:, :)    !! (nq, 2) loads on floating motions [force]
   contains
      procedure :: at
   end type straight_loads_type

contains

   !> Where the loads of an increment lie on the line through those of the ends of its step.
   subroutine follow_line(self, loading, model, step, time, f, prescribed)
      type(straight_loads_type), intent(inout) :: self
      type(loading_type), intent(in) :: loading
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      real(wp), intent(in) :: time             !! of the step, at the end of the increment
      real(wp), intent(in) :: f(:)             !! (ndof) loads then [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed) then
      real(wp), allocatable :: steady(:)

      self%fits = .false.
      if (model%step(step)%initial > pays*model%step(step)%period) return
      if (self%step /= step) then
         if (allocated(self%f)) deallocate (self%f, self%prescribed)
         allocate (self%f(size(f), 2), self%prescribed(size(prescribed), 2), steady(size(f)))
         call loads_at(loading, model, 0.0_wp, self%f(:, 1), steady)
         call loads_at(loading, model, loading%period, self%f(:, 2), steady)
         call prescribed_at(loading, model, 0.0_wp, self%prescribed(:, 1))
         call prescribed_at(loading, model, loading%period, self%prescribed(:, 2))
         self%most = maxloc([0.0_wp, abs(self%f(:, 2) - self%f(:, 1))], 1) - 1
         self%step = step
         self%ready = .false.
      end if
      self%share = time/loading%period
      self%fits = fits_line(self, f, prescribed)
      if (self%fits .or. self%most == 0) return
      ! Loads that follow one amplitude go to and fro on their line.
      associate (from => self%f(self%most, 1), to => self%f(self%most, 2))
         self%share = (f(self%most) - from)/(to - from)
      end associate
      self%fits = fits_line(self, f, prescribed)
   end subroutine follow_line

   !> Whether loads and prescribed values lie at the share in hand, to rounding.
   pure logical function fits_line(self, f, prescribed) result(fits)
      type(straight_loads_type), intent(in) :: self
      real(wp), intent(in) :: f(:)             !! (ndof) [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)

      fits = abs(self%share) <= farthest
      if (fits) fits = all(lies_at(f, self%f(:, 1), self%f(:, 2), self%share))
      if (fits) fits = all(lies_at(prescribed, self%prescribed(:, 1), self%prescribed(:, 2), &
         & self%share))
   end function fits_line

   !> To rounding.
   elemental logical function lies_at(value, from, to, share)
      real(wp), intent(in) :: value, from, to, share
      lies_at = abs(value - (from + share*(to - from))) <= 8.0_wp*epsilon(1.0_wp) &
         & *(abs(from) + abs(to))
   end function lies_at

   !> What the ends make of the increment in hand.
   pure function at(self, ends) result(value)
      class(straight_loads_type), intent(in) :: self
      real(wp), intent(in) :: ends(:, :)       !! (n, 2)
      real(wp) :: value(size(ends, 1))

      value = (1.0_wp - self%share)*ends(:, 1) + self%share*ends(:, 2)
   end function at
end module lopin_straight_loads
