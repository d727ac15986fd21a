!> Semismooth Newton on the equations of lopin_friction_rows: rows close or open, points slip or
!> not.
!>
!> Non-monotone line search on their residual (memory 4, steps 1 to 1/32). States that repeat
!> without progress end it; what it found counts only if it fits the equations point by point.
module lopin_friction_newton
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_kinds, only : wp
   use lopin_condensed, only : condensed_type
   use lopin_friction_rows, only : friction_points_type, equations_type, form_equations
   use lopin_friction_step, only : trial_type, work_type, check, search_line
   use lopin_friction_tangents, only : step_to
   use lopin_friction_scaling, only : scale_tangents, fits
   implicit none
   private
   public :: newton

   !> The edge of contact under a slender body moves by one point a step, and the residual falls
   !> only once it arrives: steps allowed grow with the points.
   integer, parameter :: least_iterations = 40, memory = 4, remembered = 32
   !> Residuals below this share of the largest force: reached, no longer falling, and repeating in
   !> the same states, as rounding of soft bodies makes them.
   real(wp), parameter :: exact = 1.0e-13_wp, accepted = 1.0e-10_wp, stalled = 1.0e-7_wp

contains

   !> Newton from x; .false. in `solved` if states repeat without progress or time is up.
   subroutine newton(self, points, work, x, solved)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      logical, intent(out) :: solved
      type(trial_type) :: next
      real(wp), allocatable :: norms(:)
      real(wp) :: norm, before, history(memory), norm_at(remembered)
      integer(int64) :: seen(remembered), hash
      integer :: pass, most, place, before_status(points%n)
      integer :: still                         !! passes in which no state has changed

      solved = .false.
      most = least_iterations + points%n
      allocate (norms(most + 1))
      seen = 0_int64
      still = 0
      history = -1.0_wp
      call form_equations(work%equations, self, points, x%force, x%gap)
      call scale_tangents(self, work)
      call check(self, points, work, x, norm)
      norms(1) = norm
      before = huge(1.0_wp)
      before_status = work%equations%status
      do pass = 1, most
         if (.not. work%predict) then
            solved = fits(self, points, work, x, exact)
            if (.not. solved .and. norm > 0.1_wp*before) &
               & solved = fits(self, points, work, x, accepted)
            if (.not. solved .and. has_stopped(norms(:pass), still)) &
               & solved = fits(self, points, work, x, stalled)
            if (allocated(work%equations%set)) solved = solved &
               & .and. all(work%equations%set .eqv. work%equations%natural)
            if (solved) exit
         end if
         before = norm
         before_status = work%equations%status
         history(1 + mod(pass, memory)) = norm
         if (work%predict) call begin_prediction(self, points, work, x, norm)
         call step_to(self, points, work, x, next)
         if (work%predict .or. work%one_by_one .or. .not. work%controls%line_search) then
            x = next
            call check(self, points, work, x, norm)
         else
            call search_line(self, points, work, x, next, maxval(history), norm)
         end if
         if (work%predict) then
            work%predict = .false.
            call scale_tangents(self, work)
            call check(self, points, work, x, norm)
            history = -1.0_wp
            before = huge(1.0_wp)
         end if
         if (work%one_by_one) call change_last(work)
         work%iterations = work%iterations + 1
         norms(pass + 1) = norm
         hash = hash_of(work%equations)
         still = merge(still + 1, 0, hash == seen(1 + mod(pass - 1, remembered)))
         if (repeats(hash, norm, pass, seen, norm_at)) exit
         seen(1 + mod(pass, remembered)) = hash
         norm_at(1 + mod(pass, remembered)) = norm
      end do
      if (.not. (work%one_by_one .or. solved)) solved = fits(self, points, work, x, stalled)
      work%norms = norms(:min(pass, most + 1))
      work%changing = pack([(place, place=1, points%n)], work%equations%status /= before_status)
   end subroutine newton

   !> The same states two passes long, and the residual is where it was: what is left is rounding.
   pure logical function has_stopped(norms, still)
      real(wp), intent(in) :: norms(:)         !! of all passes so far [force]
      integer, intent(in) :: still             !! passes in which no state has changed
      integer :: n

      n = size(norms)
      has_stopped = .false.
      if (still >= 2) has_stopped = norms(n) > 0.5_wp*norms(n - 2)
   end function has_stopped

   !> The states came before, other than in the last pass, and the residual has not halved since.
   pure logical function repeats(hash, norm, pass, seen, norm_at)
      integer(int64), intent(in) :: hash
      real(wp), intent(in) :: norm
      integer, intent(in) :: pass
      integer(int64), intent(in) :: seen(:)
      real(wp), intent(in) :: norm_at(:)
      integer :: place

      repeats = .false.
      place = findloc(seen, hash, 1)
      if (place > 0 .and. place /= 1 + mod(pass - 1, remembered)) repeats &
         & = norm > 0.5_wp*norm_at(place)
   end function repeats

   !> The first step: from states that all stick, or from the gaps of the last increment with its
   !> slips once more, so that what slid is taken to slide on.
   subroutine begin_prediction(self, points, work, x, norm)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      real(wp), intent(inout) :: norm

      if (work%cold) then
         call stick_all(points, work%touching, x, work%equations)
      else
         x%gap = work%old_gap
         call slide_on(points, x%gap)
         call check(self, points, work, x, norm)
      end if
   end subroutine begin_prediction

   !> What slid in the last increment is looked for where it would slide on by as much.
   pure subroutine slide_on(points, gap)
      type(friction_points_type), intent(in) :: points
      real(wp), intent(inout) :: gap(:)        !! (nrow) [length]
      integer :: i

      if (.not. allocated(points%way)) return
      do i = 1, points%n
         associate (from => points%tangent(i), to => points%tangent(i) + points%nt - 1)
            gap(from:to) = gap(from:to) + points%way(:, i)
         end associate
      end do
   end subroutine slide_on

   !> For the first step: points that touch, or all if bodies float, press and stick.
   subroutine stick_all(points, touching, x, equations)
      type(friction_points_type), intent(in) :: points
      logical, intent(in) :: touching(:)
      type(trial_type), intent(in) :: x            !! without forces
      type(equations_type), intent(inout) :: equations
      integer :: k, i

      where (equations%group > 0 .and. touching .and. equations%linear)
         equations%closed = .true.
         equations%residual = equations%c*(x%gap - equations%shift)
      end where
      do k = 1, points%n
         associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
            equations%closed(from:to) = equations%closed(points%normal(k))
            equations%residual(from:to) = equations%c(from)*(x%gap(from:to) - points%start(:, k))
            equations%p(:, :, k) = 0.0_wp
            equations%q(:, :, k) = 0.0_wp
            do i = 1, points%nt
               equations%p(i, i, k) = equations%c(from)*equations%extra(from + i - 1)
               equations%q(i, i, k) = equations%c(from)
            end do
         end associate
      end do
   end subroutine stick_all

   !> Of the normal rows in the wrong set, the last one changes.
   subroutine change_last(work)
      type(work_type), intent(inout) :: work
      integer :: row

      associate (e => work%equations)
         if (.not. allocated(e%set)) then
            e%set = e%closed
            return
         end if
         row = findloc(e%set .neqv. e%natural, .true., 1, back=.true.)
         if (row == 0) return
         e%set(row) = e%natural(row)
      end associate
      work%single_pivots = work%single_pivots + 1
   end subroutine change_last

   !> A number that two states share only by chance.
   pure integer(int64) function hash_of(equations) result(hash)
      type(equations_type), intent(in) :: equations
      integer :: i

      hash = 1_int64
      do i = 1, size(equations%closed)
         hash = mix(hash, merge(1_int64, 2_int64, equations%closed(i)))
      end do
      do i = 1, size(equations%status)
         hash = mix(hash, int(equations%status(i), int64))
      end do
      if (hash == 0_int64) hash = 1_int64
   end function hash_of

   !> Shifts and products modulo a prime below 2^31: no overflow.
   pure integer(int64) function mix(hash, value)
      integer(int64), intent(in) :: hash, value
      mix = mod(hash*69069_int64 + value + 12345_int64, 2147483647_int64)
   end function mix
end module lopin_friction_newton
