!> Mean gradient of the displacements of an element, and a bound of it that costs a tenth.
module lopin_mean_gradient
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, kind_of
   use lopin_flat_elements, only : is_flat
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: own_motion, gradient_of, find_reach, largest_gradients

contains

   !> Displacement of a node in the trial state [length].
   pure function own_motion(scene, model, node) result(motion)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp) :: motion(3)
      integer :: k

      motion = 0.0_wp
      do k = 1, model%mesh%ndim
         if (scene%dofs%id(k, node) > 0) motion(k) = scene%trial%motion%u(scene%dofs%id(k, node))
      end do
   end function own_motion

   !> Least squares: H = sum (u - u_mean)(x - x_mean)^T [sum (x - x_mean)(x - x_mean)^T]^-1; around
   !> the axis of revolution u/r.
   subroutine gradient_of(scene, model, e, h)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(out) :: h(3, 3)             !! du/dx [-]
      real(wp) :: x(3, 20), u(3, 20), moment(3, 3), middle(3), mean(3)
      integer :: n, k

      call places(model, e, x, n)
      do k = 1, n
         u(:, k) = own_motion(scene, model, model%mesh%conn(k, e))
      end do
      mean = sum(u(:, :n), dim=2)/n
      call second_moment(model%mesh%ndim, x(:, :n), middle, moment)
      h = 0.0_wp
      do k = 1, n
         h = h + outer(u(:, k) - mean, x(:, k) - middle)
      end do
      h = matmul(h, inverse(moment))
      if (around_axis(model, e, middle)) h(3, 3) = mean(1)/middle(1)
   end subroutine gradient_of

   !> With X the places of the nodes of an element about their mean, H = U X^+ is not larger than U
   !> over the least singular value of X, whose square is not below 1/trace((X X^T)^-1).
   subroutine find_reach(model, reach)
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(out) :: reach(:)   !! (nelement) [1/length]
      real(wp) :: x(3, 20), moment(3, 3), middle(3)
      integer :: e, n

      allocate (reach(model%mesh%nelement), source=0.0_wp)
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         call places(model, e, x, n)
         call second_moment(model%mesh%ndim, x(:, :n), middle, moment)
         moment = inverse(moment)
         reach(e) = sqrt(max(moment(1, 1), 0.0_wp) + max(moment(2, 2), 0.0_wp) &
            & + max(moment(3, 3), 0.0_wp))
         if (around_axis(model, e, middle)) reach(e) = max(reach(e), 1.0_wp/middle(1))
      end do
   end subroutine find_reach

   !> A bound of all components of the gradient of each element, from its nodes' displacements.
   subroutine largest_gradients(scene, model, reach, bound)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reach(:)         !! (nelement) [1/length]
      real(wp), intent(out) :: bound(:)        !! (nelement)
      real(wp) :: u(3), most
      integer :: e, k

      call scene%spread%squares(scene%trial%motion%u, bound)
      bound = sqrt(bound)
      if (model%kind == kind_of%axisymmetric) then
         do e = 1, model%mesh%nelement
            if (model%mesh%section(e) == 0) cycle
            most = 0.0_wp
            do k = 1, size(model%mesh%conn, 1)
               if (model%mesh%conn(k, e) == 0) exit
               u = own_motion(scene, model, model%mesh%conn(k, e))
               most = max(most, abs(u(1)))
            end do
            bound(e) = max(bound(e), most)
         end do
      end if
      bound = reach*bound
   end subroutine largest_gradients

   !> The nodes' places of an element.
   pure subroutine places(model, e, x, n)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(out) :: x(3, 20)        !! [length]
      integer, intent(out) :: n                !! nodes
      integer :: k

      n = 0
      x = 0.0_wp
      do k = 1, size(model%mesh%conn, 1)
         if (model%mesh%conn(k, e) == 0) exit
         n = n + 1
         x(:model%mesh%ndim, n) = model%mesh%x(:, model%mesh%conn(k, e))
      end do
   end subroutine places

   !> Mean of places and X X^T about it; in the plane made regular across it.
   pure subroutine second_moment(ndim, x, middle, moment)
      integer, intent(in) :: ndim
      real(wp), intent(in) :: x(:, :)          !! (3, n) [length]
      real(wp), intent(out) :: middle(3), moment(3, 3)
      integer :: k

      middle = sum(x, dim=2)/size(x, 2)
      moment = 0.0_wp
      do k = 1, size(x, 2)
         moment = moment + outer(x(:, k) - middle, x(:, k) - middle)
      end do
      if (ndim == 2) moment(3, 3) = moment(1, 1) + moment(2, 2)
   end subroutine second_moment

   !> Whether the mean displacement off the axis of revolution is a strain.
   pure logical function around_axis(model, e, middle)
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(in) :: middle(3)        !! [length]

      around_axis = model%kind == kind_of%axisymmetric .and. middle(1) > 0.0_wp
      if (around_axis) around_axis = .not. is_flat(model, e)
   end function around_axis

   pure function outer(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3, 3)
      integer :: j
      do j = 1, 3
         c(:, j) = a*b(j)
      end do
   end function outer

   pure function inverse(a) result(b)
      real(wp), intent(in) :: a(3, 3)
      real(wp) :: b(3, 3)
      integer :: i, j, p, q, r, s

      do j = 1, 3
         do i = 1, 3
            p = mod(j, 3) + 1
            q = mod(j + 1, 3) + 1
            r = mod(i, 3) + 1
            s = mod(i + 1, 3) + 1
            b(i, j) = a(p, r)*a(q, s) - a(p, s)*a(q, r)
         end do
      end do
      b = b/dot_product(a(1, :), b(:, 1))
   end function inverse
end module lopin_mean_gradient
