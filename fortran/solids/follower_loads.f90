!> Pressures that follow their faces: forces and tangents of a list of loads at finite displacement.
module lopin_follower_loads
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_solids, only : solids_type, group_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_follower_face, only : follower_force
   implicit none
   private
   public :: add_follower_loads

contains

   !> Add the forces of pressures on deformed faces to a vector of equations; `local` gets one
   !> matrix d(-force)/du per load, with a spring of zero.
   subroutine add_follower_loads(self, mesh, u, element, face, pressure, force, local)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)                 !! (n) displacements by equation [length]
      integer, intent(in) :: element(:), face(:)   !! (nload) element indices, Abaqus face numbers
      real(wp), intent(in) :: pressure(:)          !! (nload) > 0 pushes into the element [stress]
      real(wp), intent(inout) :: force(:)          !! (n) [force]
      type(local_matrix_type), allocatable, intent(out), optional :: local(:)   !! (nload)
      integer :: e, k

      if (present(local)) allocate (local(size(element)))
      do k = 1, size(element)
         e = element(k)
         if (self%which(e) == 0) then
            if (present(local)) call set_local(local(k), [integer ::], reshape([real(wp) ::], &
               & [0, 0]))
            cycle
         end if
         associate (group => self%group(self%which(e)))
            associate (cell => group%element%cell)
               call add_one(group, mesh%conn(cell%face_node(:cell%face_nnode(face(k)), face(k)), &
                  & e), k)
            end associate
         end associate
      end do

   contains

      subroutine add_one(group, node, k)
         type(group_type), intent(in) :: group
         integer, intent(in) :: node(:)           !! of the face
         integer, intent(in) :: k
         real(wp), dimension(group%element%ndim, size(node)) :: x, own
         real(wp) :: slope(group%element%ndim, size(node), group%element%ndim, size(node))
         integer :: equation(group%element%ndim, size(node)), a, i

         equation = self%dof(:group%element%ndim, node)
         x = mesh%x(:, node)
         do a = 1, size(node)
            do i = 1, group%element%ndim
               if (equation(i, a) > 0) x(i, a) = x(i, a) + u(equation(i, a))
            end do
         end do
         if (present(local)) then
            call follower_force(group%element, self%rules, face(k), x, group%thickness, &
               & pressure(k), own, slope)
            call set_local(local(k), reshape(equation, [size(x)]), &
               & reshape(slope, [size(x), size(x)]))
         else
            call follower_force(group%element, self%rules, face(k), x, group%thickness, &
               & pressure(k), own)
         end if
         do a = 1, size(node)
            do i = 1, group%element%ndim
               if (equation(i, a) > 0) force(equation(i, a)) = force(equation(i, a)) + own(i, a)
            end do
         end do
      end subroutine add_one
   end subroutine add_follower_loads

   !> Every equation once, none without a number.
   pure subroutine set_local(local, equation, k)
      type(local_matrix_type), intent(out) :: local
      integer, intent(in) :: equation(:)
      real(wp), intent(in) :: k(:, :)
      integer :: list(size(equation)), place(size(equation)), i, j, n

      n = 0
      place = 0
      do i = 1, size(equation)
         if (equation(i) <= 0) cycle
         place(i) = findloc(list(:n), equation(i), dim=1)
         if (place(i) > 0) cycle
         n = n + 1
         list(n) = equation(i)
         place(i) = n
      end do
      local%nu = n
      local%dof = list(:n)
      allocate (local%k(n, n), local%spring(n, n), source=0.0_wp)
      do j = 1, size(equation)
         if (place(j) == 0) cycle
         do i = 1, size(equation)
            if (place(i) > 0) local%k(place(i), place(j)) = local%k(place(i), place(j)) + k(i, j)
         end do
      end do
   end subroutine set_local
end module lopin_follower_loads
