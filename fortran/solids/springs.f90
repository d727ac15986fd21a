!> Springs between nodes: force, energy and stiffness of one of them.
module lopin_springs
   use lopin_kinds, only : wp
   use lopin_model, only : spring_type
   implicit none
   private
   public :: pull, spring_element

contains

   !> Force of an extension, its slope and energy. Beyond its table a force is constant.
   pure subroutine pull(self, extension, force, slope, energy)
      type(spring_type), intent(in) :: self
      real(wp), intent(in) :: extension        !! [length]
      real(wp), intent(out) :: force           !! > 0 pulls the nodes together [force]
      real(wp), intent(out) :: slope           !! [force/length]
      real(wp), intent(out) :: energy          !! from no extension on [force length]

      if (.not. allocated(self%table)) then
         force = self%stiffness*extension
         slope = self%stiffness
         energy = 0.5_wp*force*extension
         return
      end if
      call look_up(self%table, extension, force, slope)
      energy = work_to(self%table, extension) - work_to(self%table, 0.0_wp)
   end subroutine pull

   pure subroutine look_up(table, extension, force, slope)
      real(wp), intent(in) :: table(:, :)      !! (2, n) force, extension
      real(wp), intent(in) :: extension
      real(wp), intent(out) :: force, slope
      real(wp) :: own
      integer :: k, n

      n = size(table, 2)
      slope = 0.0_wp
      force = table(1, merge(1, n, extension < table(2, 1)))
      do k = 1, n - 1
         if (extension < table(2, k) .or. extension > table(2, k + 1)) cycle
         own = (table(1, k + 1) - table(1, k))/(table(2, k + 1) - table(2, k))
         force = table(1, k) + own*(extension - table(2, k))
         slope = max(slope, own)               ! the stiffer side of a kink
      end do
   end subroutine look_up

   !> Integral of the force from the first point of the table on.
   pure real(wp) function work_to(table, extension) result(work)
      real(wp), intent(in) :: table(:, :)
      real(wp), intent(in) :: extension
      real(wp) :: force, slope, from, to
      integer :: k, n

      n = size(table, 2)
      if (extension <= table(2, 1)) then
         work = table(1, 1)*(extension - table(2, 1))
         return
      end if
      work = 0.0_wp
      do k = 1, n - 1
         from = table(2, k)
         to = min(extension, table(2, k + 1))
         if (to <= from) exit
         call look_up(table(:, k:k + 1), to, force, slope)
         work = work + 0.5_wp*(table(1, k) + force)*(to - from)
      end do
      work = work + table(1, n)*max(0.0_wp, extension - table(2, n))
   end function work_to

   !> Forces on the nodes of a spring, and their derivatives. A spring along the line of its nodes
   !> turns with them where displacements are finite.
   pure subroutine spring_element(self, x, u, finite, force, k, energy)
      type(spring_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, 2) at the start [length]
      real(wp), intent(in) :: u(:, :)          !! (ndim, 2) [length]
      logical, intent(in) :: finite
      real(wp), intent(out) :: force(:, :)     !! (ndim, 2) internal: it holds the loads [force]
      real(wp), intent(out) :: k(:, :)         !! (2 ndim, 2 ndim) [force/length]
      real(wp), intent(out) :: energy          !! [force length]
      real(wp) :: g(2*size(x, 1)), line(size(x, 1)), long, rest, extension, pulls, slope
      integer :: d, i, j

      d = size(x, 1)
      long = 0.0_wp
      if (self%axial) then
         line = x(:, 2) - x(:, 1)
         rest = norm2(line)
         long = rest
         line = line/rest
         extension = dot_product(line, u(:, 2) - u(:, 1))
         if (finite) then
            line = x(:, 2) + u(:, 2) - x(:, 1) - u(:, 1)
            long = norm2(line)
            line = line/long
            extension = long - rest
         end if
         g(:d) = -line
         g(d + 1:) = line
      else
         g(:d) = -self%direction(:d, 1)
         g(d + 1:) = self%direction(:d, 2)
         extension = dot_product(g(:d), u(:, 1)) + dot_product(g(d + 1:), u(:, 2))
      end if
      call pull(self, extension, pulls, slope, energy)
      force = reshape(pulls*g, shape(force))
      do j = 1, 2*d
         k(:, j) = slope*g*g(j)
      end do
      if (.not. (self%axial .and. finite)) return
      do j = 1, d
         do i = 1, d
            associate (turn => pulls/long*(merge(1.0_wp, 0.0_wp, i == j) - line(i)*line(j)))
               k(i, j) = k(i, j) + turn
               k(d + i, d + j) = k(d + i, d + j) + turn
               k(i, d + j) = k(i, d + j) - turn
               k(d + i, j) = k(d + i, j) - turn
            end associate
         end do
      end do
   end subroutine spring_element
end module lopin_springs
