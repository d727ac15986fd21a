!> Small-strain solids in two and three dimensions: B matrices, stiffness, strains, forces of one
!> element.
!>
!> Strain rows are those of the stress order: (xx, yy, zz, xy) in 2D, (xx, yy, zz, xy, xz, yz) in
!> 3D, with engineering shears; axisymmetric elements have x = r, y = z and the hoop strain in zz,
!> and are integrated over the full circumference. B is stored transposed, dofs first: the long
!> index is contiguous. Dof (a-1)*ndim + i is component i of local node a.
module lopin_solid_small
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_gradients, only : gradients, correct_means, correct_ring_means, is_curved
   use lopin_dilatation, only : dilatation_count, dilatation_functions
   use lopin_enhanced_modes, only : modes_type, internal_modes, solve_small
   use lopin_hourglass, only : stiffen_hourglass
   use lopin_facets, only : facet_rule_type, facet_point
   implicit none
   private
   public :: strain_matrices, stiffness, strains, internal_force, body_force, face_force, &
      & gauss_points, fill_solid, fill_plane, add_product, mode_strains, follow_nodes

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> B at every Gauss point, mean dilatation included, and the volume of each point.
   !>
   !> B-bar (Hughes 1980): the dilatation of a point is replaced by its mean over the element, or
   !> its linear part, so that nearly incompressible material locks no more. The internal modes of
   !> an enhanced element follow the nodes, if `d` says the material. Where `smallest` <= 0 the
   !> element is folded and nothing else is defined.
   pure subroutine strain_matrices(element, x, thickness, b, volume, smallest, point, d)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) coordinates [length]
      real(wp), intent(in) :: thickness        !! plane kinds, else ignored [length]
      real(wp), intent(out) :: b(element%ndof, element%nstress, element%ngauss)   !! [1/length]
      real(wp), intent(out) :: volume(element%ngauss)   !! times thickness or 2 pi r
      real(wp), intent(out) :: smallest        !! least det J [length^ndim]
      integer, intent(out) :: point            !! and its Gauss point
      real(wp), intent(in), optional :: d(:, :)   !! (nstress, nstress) Hooke [stress]
      real(wp) :: g(element%ndim, element%nnode, element%ngauss), determinant, radius
      real(wp) :: own(element%nmode, element%nstress, element%ngauss)
      integer :: k

      smallest = huge(1.0_wp)
      point = 1
      do k = 1, element%ngauss
         call gradients(element%ndim, element%nnode, x, element%dn(:, :, k), g(:, :, k), &
            & determinant)
         if (determinant < smallest) then
            smallest = determinant
            point = k
         end if
         if (determinant <= 0.0_wp) cycle
         volume(k) = element%weight(k)*determinant
         if (element%ndim == 3) then
            call fill_solid(element%nnode, g(:, :, k), b(:, :, k))
         else
            call fill_plane(element%nnode, g(:, :, k), b(:, :, k))
            if (element%axisymmetric) then
               radius = dot_product(x(1, :element%nnode), element%n(:, k))
               if (radius <= 0.0_wp) then
                  smallest = min(smallest, radius*determinant)
                  point = k
                  cycle
               end if
               b(1::2, 3, k) = element%n(:, k)/radius
               volume(k) = volume(k)*2.0_wp*pi*radius
            else
               volume(k) = volume(k)*thickness
            end if
         end if
      end do
      if (smallest <= 0.0_wp) return
      if (allocated(element%whole_weight)) call correct_curved(element, x, g, volume, b)
      if (dilatation_count(element) > 0) call average_dilatation(element, x, volume, b)
      if (element%nmode == 0 .or. .not. present(d)) return
      call mode_strains(element, x, own)
      call follow_nodes(element, own, spread(d, 3, element%ngauss), volume, b)
   end subroutine strain_matrices

   !> B where curved edges ask for other gradients, lopin_gradients.
   pure subroutine correct_curved(element, x, g, volume, b)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(inout) :: g(element%ndim, element%nnode, element%ngauss), volume(:)
      real(wp), intent(inout) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp) :: hoop(element%nnode), round(element%ngauss)
      integer :: k

      if (.not. is_curved(element, x)) return
      if (element%ndim == 3) then
         call correct_means(element, x, g, volume)
         do k = 1, element%ngauss
            call fill_solid(element%nnode, g(:, :, k), b(:, :, k))
         end do
         return
      end if
      round = 2.0_wp*pi*matmul(x(1, :element%nnode), element%n)
      volume = volume/round
      call correct_ring_means(element, x, g, volume, hoop)
      do k = 1, element%ngauss
         call fill_plane(element%nnode, g(:, :, k), b(:, :, k))
         b(1::2, 3, k) = 2.0_wp*pi*element%n(:, k)/round(k) + hoop
      end do
      volume = volume*round
   end subroutine correct_curved

   !> Strains of the internal modes at the Gauss points, laid out as B.
   pure subroutine mode_strains(element, x, own)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode), unfolded [length]
      real(wp), intent(out) :: own(element%nmode, element%nstress, element%ngauss)
      type(modes_type) :: modes
      real(wp) :: smallest
      integer :: s
      integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]

      call internal_modes(element, x, modes, smallest)
      do s = 1, element%nstress
         own(:, s, :) = modes%e(row(s), column(s), :element%nmode, :element%ngauss)
         if (s > 3) own(:, s, :) = own(:, s, :) &
            & + modes%e(column(s), row(s), :element%nmode, :element%ngauss)
      end do
   end subroutine mode_strains

   !> Let the internal modes follow the nodes in balance: their strains are added to B.
   pure subroutine follow_nodes(element, own, d, volume, b)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: own(element%nmode, element%nstress, element%ngauss)
      real(wp), intent(in) :: d(element%nstress, element%nstress, element%ngauss)   !! [stress]
      real(wp), intent(in) :: volume(element%ngauss)
      real(wp), intent(inout) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp) :: pivot(element%nmode, element%nmode), follow(element%nmode, element%ndof)
      real(wp) :: half(element%nmode, element%nstress)
      integer :: k
      logical :: regular

      pivot = 0.0_wp
      follow = 0.0_wp
      do k = 1, element%ngauss
         half = volume(k)*matmul(own(:, :, k), d(:, :, k))
         pivot = pivot + matmul(half, transpose(own(:, :, k)))
         follow = follow + matmul(half, transpose(b(:, :, k)))
      end do
      call solve_small(pivot, follow, regular)
      if (.not. regular) return
      do k = 1, element%ngauss
         b(:, :, k) = b(:, :, k) - matmul(transpose(follow), own(:, :, k))
      end do
   end subroutine follow_nodes

   pure subroutine fill_solid(nnode, g, b)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(3, nnode)
      real(wp), intent(out) :: b(3*nnode, 6)
      integer :: a, i

      b = 0.0_wp
      do a = 1, nnode
         i = 3*a - 2
         b(i, 1) = g(1, a)
         b(i, 4) = g(2, a)
         b(i, 5) = g(3, a)
         b(i + 1, 2) = g(2, a)
         b(i + 1, 4) = g(1, a)
         b(i + 1, 6) = g(3, a)
         b(i + 2, 3) = g(3, a)
         b(i + 2, 5) = g(1, a)
         b(i + 2, 6) = g(2, a)
      end do
   end subroutine fill_solid

   pure subroutine fill_plane(nnode, g, b)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(2, nnode)
      real(wp), intent(out) :: b(2*nnode, 4)

      b = 0.0_wp
      b(1::2, 1) = g(1, :)
      b(1::2, 4) = g(2, :)
      b(2::2, 2) = g(2, :)
      b(2::2, 4) = g(1, :)
   end subroutine fill_plane

   pure subroutine average_dilatation(element, x, volume, b)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :), volume(element%ngauss)
      real(wp), intent(inout) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      real(wp) :: part(element%ndof, dilatation_count(element)), change(element%ndof)
      integer :: k, m, s

      if (size(phi, 2) == 1) then
         phi = 1.0_wp   ! the mean itself, without the rounding of a square root
      else
         call dilatation_functions(element, x, volume, phi)
      end if
      part = 0.0_wp
      do k = 1, element%ngauss
         change = volume(k)*(b(:, 1, k) + b(:, 2, k) + b(:, 3, k))
         do m = 1, size(phi, 2)
            part(:, m) = part(:, m) + phi(k, m)*change
         end do
      end do
      if (size(phi, 2) == 1) part = part/sum(volume)
      do k = 1, element%ngauss
         change = (matmul(part, phi(k, :)) - b(:, 1, k) - b(:, 2, k) - b(:, 3, k))/3.0_wp
         do s = 1, 3
            b(:, s, k) = b(:, s, k) + change
         end do
      end do
   end subroutine average_dilatation

   !> Tangent stiffness: the integral of B D B^T.
   pure subroutine stiffness(element, x, thickness, d, ke, smallest, point)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      real(wp), intent(in) :: thickness      !! plane kinds [length]
      real(wp), intent(in) :: d(:, :)        !! (nstress, nstress) symmetric [stress]
      real(wp), intent(out) :: ke(element%ndof, element%ndof)   !! [force/length]
      real(wp), intent(out) :: smallest      !! least det J; nothing is defined unless > 0
      integer, intent(out) :: point          !! its Gauss point
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      integer :: i, k

      call strain_matrices(element, x, thickness, b, volume, smallest, point, d)
      if (smallest <= 0.0_wp) return
      ke = 0.0_wp
      do k = 1, element%ngauss
         call add_product(element%ndof, element%nstress, b(:, :, k), volume(k)*d, ke)
      end do
      do i = 2, element%ndof
         ke(:i - 1, i) = ke(i, :i - 1)
      end do
      if (element%hourglass) call stiffen_hourglass(element, d, thickness, x(:, :element%nnode), &
         & ke)
   end subroutine stiffness

   !> Lower triangle of ke + b d b^T.
   pure subroutine add_product(n, m, b, d, ke)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: b(n, m), d(m, m)
      real(wp), intent(inout) :: ke(n, n)
      real(wp) :: db(n, m)
      integer :: i, j, s, t

      db = 0.0_wp
      do s = 1, m
         do t = 1, m
            if (abs(d(t, s)) <= 0.0_wp) cycle
            db(:, s) = db(:, s) + b(:, t)*d(t, s)
         end do
      end do
      ! Written out, as one pass over a column of ke is what costs time.
      do j = 1, n
         if (m == 4) then
            do i = j, n
               ke(i, j) = ke(i, j) + db(i, 1)*b(j, 1) + db(i, 2)*b(j, 2) + db(i, 3)*b(j, 3) &
                  & + db(i, 4)*b(j, 4)
            end do
         else
            do i = j, n
               ke(i, j) = ke(i, j) + db(i, 1)*b(j, 1) + db(i, 2)*b(j, 2) + db(i, 3)*b(j, 3) &
                  & + db(i, 4)*b(j, 4) + db(i, 5)*b(j, 5) + db(i, 6)*b(j, 6)
            end do
         end if
      end do
   end subroutine add_product

   !> Strains at the Gauss points.
   pure subroutine strains(element, b, u, strain)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: b(element%ndof, element%nstress, element%ngauss) !! of strain_matrices
      real(wp), intent(in) :: u(element%ndof)                                    !! [length]
      real(wp), intent(out) :: strain(element%nstress, element%ngauss)
      integer :: k, s

      do k = 1, element%ngauss
         do s = 1, element%nstress
            strain(s, k) = dot_product(b(:, s, k), u)
         end do
      end do
   end subroutine strains

   !> Nodal forces that a stress field needs for balance: the integral of B stress.
   pure subroutine internal_force(element, b, volume, stress, force)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp), intent(in) :: volume(element%ngauss)
      real(wp), intent(in) :: stress(element%nstress, element%ngauss)   !! [stress]
      real(wp), intent(out) :: force(element%ndof)                      !! [force]
      integer :: k, s

      force = 0.0_wp
      do k = 1, element%ngauss
         do s = 1, element%nstress
            force = force + volume(k)*stress(s, k)*b(:, s, k)
         end do
      end do
   end subroutine internal_force

   !> Consistent nodal forces of a uniform force per volume.
   pure subroutine body_force(element, volume, density, force)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: volume(element%ngauss)   !! of strain_matrices
      real(wp), intent(in) :: density(:)               !! (ndim) [force/length^3]
      real(wp), intent(out) :: force(element%ndim, element%nnode)   !! [force]
      real(wp) :: share(element%nnode)
      integer :: a

      share = matmul(element%n, volume)
      do a = 1, element%nnode
         force(:, a) = density(:element%ndim)*share(a)
      end do
   end subroutine body_force

   !> Consistent nodal forces of a pressure and a traction on one face; zero at the other nodes.
   pure subroutine face_force(element, rules, face, x, thickness, pressure, traction, force)
      type(element_type), intent(in) :: element
      type(facet_rule_type), intent(in) :: rules(:)   !! of new_facet_rules
      integer, intent(in) :: face                     !! Abaqus face number
      real(wp), intent(in) :: x(:, :)                 !! (ndim, nnode) of the element [length]
      real(wp), intent(in) :: thickness               !! plane kinds [length]
      real(wp), intent(in) :: pressure                !! > 0 pushes into the element [stress]
      real(wp), intent(in) :: traction(:)             !! (ndim) added to the pressure [stress]
      real(wp), intent(out) :: force(element%ndim, element%nnode)   !! [force]
      real(wp) :: normal(element%ndim), area, push(element%ndim)
      integer :: node(8), a, k, m

      force = 0.0_wp
      m = element%cell%face_nnode(face)
      node(:m) = element%cell%face_node(:m, face)
      associate (rule => rules(element%cell%face_cell(face)))
         do k = 1, rule%npoint
            call facet_point(rule, k, x(:, node(:m)), element%axisymmetric, normal, area)
            if (element%kind <= element_kind%plane_stress) area = area*thickness
            push = area*(traction(:element%ndim) - pressure*normal)
            do a = 1, m
               force(:, node(a)) = force(:, node(a)) + rule%n(a, k)*push
            end do
         end do
      end associate
   end subroutine face_force

   !> Coordinates of the Gauss points.
   pure function gauss_points(element, x) result(points)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)   !! (ndim, nnode) [length]
      real(wp) :: points(element%ndim, element%ngauss)
      points = matmul(x(:, :element%nnode), element%n)
   end function gauss_points
end module lopin_solid_small
