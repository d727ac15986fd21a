!> One increment of contact with friction on a plain compliance, with the switches of an atlas.
module lopin_probes_friction_set
   use lopin_active_set, only : contact_result_type, outcome
   use lopin_condensed, only : condensed_type
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_error, only : error_code
   use lopin_friction, only : law_of
   use lopin_friction_limits, only : find_wedging
   use lopin_friction_rows, only : friction_points_type
   use lopin_friction_set, only : solve_friction, friction_result_type, friction_controls_type
   use lopin_kinds, only : wp
   implicit none
   private
   public :: friction_increment

contains

   !> Coulomb's friction at points in the plane: the first half of the rows presses, the other
   !> slides. `code` is 0, 2 for sizes that do not fit, 3 for states that do not settle.
   subroutine friction_increment(compliance, law, switch, before, after, info, code)
      real(wp), intent(in) :: compliance(:, :)     !! (2 n, 2 n) symmetric [length/force]
      real(wp), intent(in) :: law(3)   !! coefficient [-]; springs, normal and tangential, 0: exact
                                       !! [force/length]; c_t times the mean nodal compliance, 0:
                                       !! the rule [-]
      integer, intent(in) :: switch(:)   !! warm, line search, predict, ladder: 1 on, 0 off
      real(wp), intent(in) :: before(:, :)   !! (2 n, 3) gap without forces [length]; accepted last:
                                             !! force [force], gap [length]
      real(wp), intent(out) :: after(:, :)         !! (2 n, 2) force [force], gap [length]
      real(wp), intent(out) :: info(:)   !! (7) iterations, cure, sticking, slipping, wedging point,
                                         !! sign; critical coefficient of that point [-]
      integer, intent(out) :: code
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result
      type(friction_result_type) :: friction
      type(friction_controls_type) :: controls
      real(wp) :: coefficient, critical
      integer :: n, wedging

      info = 0.0_wp
      after = before(:, 2:)
      code = error_code%usage
      n = size(before, 1)
      if (n == 0 .or. mod(n, 2) /= 0) return
      call new_problem(problem, compliance, law(2))
      call new_points(points, n/2, law(1), law(2), before(:, 2), before(:, 3))
      controls = friction_controls_type(law(3), switch(2) == 1, switch(3) == 1, switch(4) == 1)
      if (switch(1) == 1) then
         result%force = before(:, 2)
         result%gap = before(:, 3)
         allocate (result%q(0))
      end if
      call solve_friction(problem, points, before(:, 1), spread(0.0_wp, 1, n), [real(wp) ::], &
         & result, friction, controls)
      code = merge(0, error_code%not_converged, result%outcome == outcome%solved)
      after(:, 1) = result%force
      after(:, 2) = result%gap
      critical = 0.0_wp
      call find_wedging(problem%s, points, friction%status, wedging, coefficient, critical)
      info(:6) = [result%iterations, friction%cure, count(friction%status == 1), &
         & count(friction%status == 2), wedging, friction%sign_of_determinant]
      info(7) = critical
   end subroutine friction_increment

   !> A unit stiffness under every row, and the compliance as it is.
   subroutine new_problem(problem, compliance, alpha)
      type(condensed_type), intent(out) :: problem
      real(wp), intent(in) :: compliance(:, :), alpha
      integer :: i, n

      n = size(compliance, 1)
      problem%n = n
      problem%nrow = n
      problem%ngroup = 1
      allocate (problem%l(n, n), problem%c(n, 0), source=0.0_wp)
      do i = 1, n
         problem%l(i, i) = 1.0_wp
      end do
      problem%first = [(i, i=1, n + 1)]
      problem%column = [(i, i=1, n)]
      problem%value = spread(1.0_wp, 1, n)
      problem%s = compliance
      problem%bilateral = spread(.false., 1, n)
      problem%alpha = spread(alpha, 1, n)
      problem%group_first = [1, n/2 + 1]
      problem%max_augmentations = [0]
      problem%penetration = [0.0_wp]
      allocate (problem%group(1))
      call new_enforcement(problem%group(1)%method, trim(merge('penalty ', 'lagrange', &
         & alpha > 0.0_wp)))
   end subroutine new_problem

   !> Points that keep what the last increment left.
   subroutine new_points(points, n, mu, alpha, force, gaps)
      type(friction_points_type), intent(out) :: points
      integer, intent(in) :: n
      real(wp), intent(in) :: mu, alpha, force(:), gaps(:)
      integer :: i

      points%n = n
      points%nt = 1
      points%normal = [(i, i=1, n)]
      points%tangent = [(n + i, i=1, n)]
      allocate (points%law(n), points%at(n))
      points%law%law = law_of%coulomb
      points%law%mu = mu
      points%weight = spread(1.0_wp, 1, n)
      points%stiffness = spread(alpha, 1, n)
      points%elastic_slip = spread(0.0_wp, 1, n)
      points%augmented = spread(.false., 1, n)
      allocate (points%traction(1, n), points%start(1, n), points%anchor(1, n), &
         & points%elastic(1, n), source=0.0_wp)
      points%traction(1, :) = force(n + 1:)
      points%start(1, :) = gaps(n + 1:)
      if (alpha > 0.0_wp) points%elastic(1, :) = -force(n + 1:)/alpha
   end subroutine new_points
end module lopin_probes_friction_set
